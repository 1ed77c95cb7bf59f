// Forces of machine elements, with their states of first order eliminated.
//
// The states of an element obey z' = g(t, s, v, z), with s and v its argument and the rate of it. Within a
// step they are the root of z = z_known + z_weight g (State::z_weight), a function of s and v: the force
// f(t, s, v, z(s, v)) is one of s and v alone, with the derivatives
//   df/ds = f_s + f_z (1 - z_weight g_z)^-1 z_weight g_s,   likewise df/dv.
//
// At rest (State::at_rest) they are the root of g(t, s, v = 0, z) = 0, a function of s alone. Where g leaves
// them undetermined they have the value to which a motion from the start would bring them:
//   closed valve       each chamber keeps its mass of oil, or, with leakage, both together: V e^(p/B)
//   control of a rate  with the target 0 the integral is -s, but for a constant: z + s
//   control of s       the integral is the multiplier of the condition that the error vanishes. z_known is
//   its
//                      last value, and z = z_known + z_weight g as within a step
#pragma once

#include "mbd_server/forces/spring_damper.hpp"
#include "mbd_server/model/model.hpp"
#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

// At most two states; unused ones are zero.
using StatesOfElement = Eigen::Vector2d;

struct ElementValue {
  double force = 0;         // on the coordinate, or extending the cylinder [N m] or [N]
  double passive = 0;       // part of it: damping, friction, brake and ends
  double d_s = 0, d_v = 0;  // its derivatives
  StatesOfElement z = StatesOfElement::Zero(), zdot = StatesOfElement::Zero();
};
ElementValue evaluate(const Element& element, const Model& model, const State& state, double s, double v);
// What the states of an element keep while the machine comes to rest, for State::z_known.
StatesOfElement kept_at_rest(const Element& element, double s, const StatesOfElement& z);
// Whether a state is a multiplier at rest, see above.
bool has_multiplier_at_rest(const Element& element);

// Derivatives of the force and of the rates of the states, f(t, s, v, z) and g(t, s, v, z). Those of the
// force at constant states are ElementValue::d_s and d_v with z_weight 0.
struct ElementDerivatives {
  Eigen::RowVector2d f_z = Eigen::RowVector2d::Zero();
  StatesOfElement g_s = StatesOfElement::Zero(), g_v = StatesOfElement::Zero();
  Eigen::Matrix2d g_z = Eigen::Matrix2d::Zero();
  // Combinations of the states and s that are constant in every small motion, as the mass of oil.
  int constants = 0;
};
ElementDerivatives derivatives(const Element& element, const Model& model, const State& state, double s,
                               double v);

// Argument of an element: coordinate of a motor's joint, stroke of a cylinder; and its rate.
struct ElementArgument {
  double s = 0, v = 0;
};
ElementArgument argument(const Element& element, const std::vector<LinkMotion>& links);
// Force of a cylinder at its ends, as that of a spring.
SpringForce along_line(const Element& element, const ElementValue& value,
                       const std::vector<LinkMotion>& links);

// Value of its target, throttle, force or opening.
double signal_of(const Element& element, const Model& model, const State& at);

// What an element does at given states: power that comes in, and that is lost [W].
struct ElementPower {
  double work = 0, lost = 0;
};
ElementPower power(const Element& element, const Model& model, const State& at, ElementArgument x,
                   const StatesOfElement& z);
// Energy stored in compressed oil and at the ends [J].
double stored_energy(const Element& element, double s, const StatesOfElement& z);
// Flows into the chambers of a hydraulic cylinder through its valve [m3/s].
struct ChamberFlows {
  double a = 0, b = 0;
};
ChamberFlows valve_flows(const Element& element, const Model& model, const State& at,
                         const StatesOfElement& z);

StatesOfElement states_of(const Element& element, const VectorXd& z);

}  // namespace tandem::mbd
