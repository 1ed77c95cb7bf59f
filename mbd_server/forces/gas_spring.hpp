// The law of a gas spring: a polytropic gas, some of which may leak out.
//
//   p = p_0 (mu V_0 / V)^n      V = V_0 + A s      F = A (p - p_a)      mu' = -L (p - p_a) / V_0
//
// with the share mu of the gas of the start that is left, the state. The force pushes the ends apart.
#pragma once

#include "mbd_server/forces/element_force.hpp"

namespace tandem::mbd {

struct GasSpring final : ElementLaw {
  double area = 0;                   // A [m2]
  double pressure = 0, ambient = 0;  // p_0, p_a; absolute [Pa]
  double volume = 0;                 // V_0 [m3]
  double exponent = 1;               // n >= 1
  double leakage = 0;                // L [m3/(s Pa)]; 0: there is no state

  bool dissipates() const override { return leakage > 0; }
  // Throws Error{numerics} where no volume is left, or where a step does not resolve the leak.
  ElementValue evaluate(const LawInput& in, double s, double v) const override;
  ElementDerivatives derivatives(const LawInput& in, double s, double v,
                                 const StatesOfElement& z) const override;
  void expect_rest(const LawInput& in) const override;
  ElementPower power(const LawInput& in, ElementArgument x, const StatesOfElement& z) const override;
  double stored_energy(double s, const StatesOfElement& z) const override;
  void observe(int account, const LawInput& in, ElementArgument x, const StatesOfElement& z,
               ChannelValues& to) const override;

  double pressure_at(double s, const StatesOfElement& z) const;
};

}  // namespace tandem::mbd
