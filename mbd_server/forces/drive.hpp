// The law of a drive: a controlled or given force on one argument.
#pragma once

#include <limits>

#include "mbd_server/forces/element_law.hpp"
#include "mbd_server/model/force_law.hpp"

namespace tandem::mbd {

// A force that follows its signal: PI or PID control of the argument or of its rate, or the signal itself.
struct Drive final : ElementLaw {
  enum class Of { position, rate, force } of = Of::force;
  // Per error of the argument [1] or of its rate, its integral and its derivative.
  double proportional = 0, integral = 0, derivative = 0;
  double filter = 0;       // time constant of the derivative [s]; 0: none
  double anti_windup = 0;  // time constant by which a limited force draws the integral back [s]
  double limit = std::numeric_limits<double>::infinity();  // of the force
  // Torque at the motor's shaft over its speed [N m], [rad/s]: for a signal the torque at signal 1, else the
  // limit at either direction.
  ForceLaw curve;
  double gear = 1;  // speed of the shaft over the rate [-]

  bool has_integral() const { return integral != 0; }
  bool has_filter() const { return filter > 0 && derivative != 0; }

  ElementValue evaluate(const LawInput& in, double s, double v) const override;
  ElementDerivatives derivatives(const LawInput& in, double s, double v,
                                 const StatesOfElement& z) const override;
  ElementValue at_rest(const LawInput& in, double s) const override;
  StatesOfElement kept_at_rest(double s, const StatesOfElement& z) const override;
  bool has_multiplier_at_rest() const override { return of == Of::position && has_integral(); }
  // An integral over a rate that its target asks for grows without end, unless the force is limited.
  void expect_rest(const LawInput& in) const override;
  ElementPower power(const LawInput& in, ElementArgument x, const StatesOfElement& z) const override;
};

// The states and the force. `known` and `weight` as in State::z_known, z_weight; with weight 0 the states are
// `known`.
ElementValue evaluate(const Drive& drive, SignalValue target, double s, double v,
                      const StatesOfElement& known, double weight);

}  // namespace tandem::mbd
