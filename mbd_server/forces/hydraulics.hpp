// The law of a hydraulic cylinder: two chambers of compressible oil, a valve with four edges, leakage.
//
//   V_a p_a' = B (Q_a - Q_l - A_a v)      V_a = V_0 + A_a (s - lower)
//   V_b p_b' = B (Q_b + Q_l + A_b v)      V_b = V_0 + A_b (upper - s)
//   Q = K x dp / (dp^2 + d^2)^(1/4)       through an edge that is open by x, at the pressure drop dp
//
// For x > 0 the supply feeds chamber a and chamber b empties into the tank, for x < 0 the other way around.
// K is the flow of a fully open edge at the scene's pressure drop; well below d the flow is laminar. The
// supply gives at most the flow of its pump: then its pressure falls until the edge lets no more pass.
#pragma once

#include <limits>

#include "mbd_server/forces/element_law.hpp"

namespace tandem::mbd {

// Two chambers and a valve; pressures relative to the atmosphere. The states are the pressures of chamber a,
// which extends the cylinder, and of chamber b.
struct Hydraulics final : ElementLaw {
  double area_a = 0, area_b = 0;                          // of the piston [m2]
  double volume = 0;                                      // dead volume of each chamber [m3]
  double lower = 0, upper = 0;                            // strokes at which only the dead volume is left [m]
  double modulus = 0;                                     // bulk modulus [Pa]
  double supply = 0, tank = 0;                            // [Pa]
  double pump = std::numeric_limits<double>::infinity();  // largest flow of the supply [m3/s]
  double flow = 0, drop = 1;  // of one fully open edge: flow [m3/s] at a pressure drop [Pa]
  double laminar = 0;         // pressure drop below which the flow is laminar [Pa]
  double leakage = 0;         // across the piston [m3/(s Pa)]
  double cavitation = 0;      // below this pressure the law is not valid [Pa]

  bool dissipates() const override { return true; }
  // Throws Error{numerics} where a chamber has no volume left in a step, as at_rest() does.
  ElementValue evaluate(const LawInput& in, double s, double v) const override;
  ElementDerivatives derivatives(const LawInput& in, double s, double v,
                                 const StatesOfElement& p) const override;
  // Pressures that rest there: those of the supply and the tank if the valve is open, else those of the oil
  // that is kept.
  ElementValue at_rest(const LawInput& in, double s) const override;
  // The pressures that the oil of each chamber would have in its dead volume.
  StatesOfElement kept_at_rest(double s, const StatesOfElement& p) const override;
  // The energy that enters from the supply less that which leaves into the tank, and what valve and leakage
  // dissipate [W].
  ElementPower power(const LawInput& in, ElementArgument x, const StatesOfElement& p) const override;
  // Energy of the compressed oil: V B (e^x - 1 - x) with x = p / B [J].
  double stored_energy(double s, const StatesOfElement& p) const override;
  void observe(int account, const LawInput& in, ElementArgument x, const StatesOfElement& p,
               ChannelValues& to) const override;
};

// Flows into the chambers through the valve [m3/s].
struct ChamberFlows {
  double a = 0, b = 0;
};
ChamberFlows valve_flows(const Hydraulics& law, double opening, const StatesOfElement& p);

}  // namespace tandem::mbd
