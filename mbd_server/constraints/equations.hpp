// The equations of closures at a state, their derivatives and the forces of their multipliers.
#pragma once

#include <vector>

#include "mbd_server/kinematics/kinematics.hpp"
#include "mbd_server/model/closure.hpp"

namespace tandem::mbd {

// One equation at a state.
struct EquationValue {
  double position = 0, velocity = 0, acceleration = 0;  // phi and its derivatives along the motion
  double position_floor = 0, velocity_floor = 0;        // values below these are round-off
  Vector6d c_a, c_b;              // d phi = c_b . psi_b - c_a . psi_a for displacements psi of the links
  double on_q_a = 0, on_q_b = 0;  // the same for joint coordinates, couplers only
  double on_q_a_per_q_a = 0;      // derivative of on_q_a, cams only
};
// The factor of a link's coordinate in the equation of a coupler.
inline double on_coordinate(const Closure& c, const EquationValue& e, LinkIndex link) {
  for (const CoupledLink& term : c.terms)
    if (term.link == link) return term.factor;
  if (!c.terms.empty()) return 0;
  return link == c.a ? e.on_q_a : (link == c.b ? e.on_q_b : 0);
}
EquationValue evaluate(const Closure& closure, const Equation& equation,
                       const std::vector<LinkMotion>& links);
// All equations of a closure.
void evaluate(const Closure& closure, const std::vector<LinkMotion>& links, EquationValue* values);

// Geometric stiffness of an equation: the change of its wrench c lambda when the links are displaced by
// psi_a, psi_b. Point equations have none: their force keeps its direction and acts at a point of the body.
struct GeometricStiffness {
  Matrix6d by_a = Matrix6d::Zero(), by_b = Matrix6d::Zero();
};
void add_geometric_stiffness(const Closure& closure, const Equation& equation,
                             const std::vector<LinkMotion>& links, double lambda,
                             GeometricStiffness& turning);

// Angle of b about the axis of a closure relative to a, in (-pi, pi] [rad], and displacement along it [m].
double angle(const Closure& closure, const std::vector<LinkMotion>& links);
double travel(const Closure& closure, const std::vector<LinkMotion>& links);

}  // namespace tandem::mbd
