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

#include "mbd_server/forces/element_force.hpp"

namespace tandem::mbd {

// The pressures and the force. `known`, `weight` as in State::z_known, z_weight; `guess`: of the pressures.
// Throws Error{numerics} where a chamber has no volume left in a step.
ElementValue evaluate(const Hydraulics& law, const std::string& name, double opening, double s, double v,
                      const StatesOfElement& known, double weight, const StatesOfElement& guess);

// As evaluate() at the rate 0, with pressures that rest there: those of the supply and the tank if the valve
// is open, else those of the oil that is `kept` (State::z_known). Throws as above.
ElementValue at_rest(const Hydraulics& law, const std::string& name, double opening, double s,
                     const StatesOfElement& kept, const StatesOfElement& guess);
// The pressures that the oil of each chamber would have in its dead volume.
StatesOfElement kept_at_rest(const Hydraulics& law, double s, const StatesOfElement& p);
ElementDerivatives derivatives(const Hydraulics& law, double opening, double s, double v,
                               const StatesOfElement& p);

ChamberFlows valve_flows(const Hydraulics& law, double opening, const StatesOfElement& p);
// The energy that enters from the supply less that which leaves into the tank, and what valve and leakage
// dissipate [W].
ElementPower power(const Hydraulics& law, double opening, const StatesOfElement& p);
// Energy of the compressed oil: V B (e^x - 1 - x) with x = p / B [J].
double stored_energy(const Hydraulics& law, double s, const StatesOfElement& p);

}  // namespace tandem::mbd
