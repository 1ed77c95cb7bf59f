// The law of a machine element: a scalar force of one argument, the coordinate of a joint or the distance of
// two points, and of its rate. A law may have up to two states of first order, which depend on nothing but
// that argument and time: the element eliminates them (forces/element_force.hpp).
#pragma once

#include <string>

#include "mbd_server/forces/channel_values.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

// At most two states; unused ones are zero.
using StatesOfElement = Eigen::Vector2d;

// Value and rate of a signal.
struct SignalValue {
  double value = 0, rate = 0;
};

struct ElementValue {
  double force = 0;         // on the coordinate, or extending the cylinder [N m] or [N]
  double passive = 0;       // part of it: damping, friction, brake and ends
  double d_s = 0, d_v = 0;  // its derivatives
  StatesOfElement z = StatesOfElement::Zero(), zdot = StatesOfElement::Zero();
};

// Derivatives of the force and of the rates of the states, f(t, s, v, z) and g(t, s, v, z). Those of the
// force at constant states are ElementValue::d_s and d_v with z_weight 0.
struct ElementDerivatives {
  Eigen::RowVector2d f_z = Eigen::RowVector2d::Zero();
  StatesOfElement g_s = StatesOfElement::Zero(), g_v = StatesOfElement::Zero();
  Eigen::Matrix2d g_z = Eigen::Matrix2d::Zero();
  // Combinations of the states and s that are constant in every small motion, as the mass of oil.
  int constants = 0;
};

// Argument of an element: coordinate of a motor's joint, stroke of a cylinder; and its rate.
struct ElementArgument {
  double s = 0, v = 0;
};

// What an element does at given states: power that comes in, and that is lost [W].
struct ElementPower {
  double work = 0, lost = 0;
};

// What a law depends on besides its argument. `known` and `weight` as State::z_known and z_weight; with
// weight 0 the states are `known`. `guess`: of the states.
struct LawInput {
  const std::string& name;  // of the element, for messages
  SignalValue signal;
  StatesOfElement known = StatesOfElement::Zero(), guess = known;
  double weight = 0;
};

class ElementLaw {
 public:
  virtual ~ElementLaw() = default;
  virtual bool dissipates() const { return false; }

  // The states and the force.
  virtual ElementValue evaluate(const LawInput& in, double s, double v) const = 0;
  virtual ElementDerivatives derivatives(const LawInput& in, double s, double v,
                                         const StatesOfElement& z) const = 0;

  // As evaluate() at the rate 0, with states that rest there; of a law with states. `known` is what they keep
  // while the machine comes to rest, kept_at_rest(); `weight` counts for a multiplier only.
  virtual ElementValue at_rest(const LawInput& in, double s) const { return evaluate(in, s, 0); }
  virtual StatesOfElement kept_at_rest(double /*s*/, const StatesOfElement& z) const { return z; }
  // Whether a state is a multiplier at rest (element_force.hpp).
  virtual bool has_multiplier_at_rest() const { return false; }
  // Throws Error{scene} where the law never comes to rest.
  virtual void expect_rest(const LawInput&) const {}

  virtual ElementPower power(const LawInput& in, ElementArgument x, const StatesOfElement& z) const = 0;
  virtual double stored_energy(double /*s*/, const StatesOfElement&) const { return 0; }
  // Channels of its own.
  virtual void observe(int /*account*/, const LawInput&, ElementArgument, const StatesOfElement&,
                       ChannelValues&) const {}
};

}  // namespace tandem::mbd
