// The brush tyre on the plane of the road under it (forces/tyre_road.hpp): a vertical spring and damper, a
// brush with parabolic pressure whose slip follows with a relaxation length, and rolling resistance
// ([Pacejka2012], chapters 3 and 7).
//
// The two states of a tyre are the deflections of its tread along and across the wheel's plane. They obey
//   w' = -V_s - (|V_r| + |V_s| g(psi)) w / sigma,   g = max(0, psi - 1)
// with the sliding velocity V_s of the wheel at the point of contact and the rolling speed V_r. In steady
// rolling w / sigma is the theoretical slip -V_s / V_r. The second term acts while all of the tread slides,
// where the force does not depend on w; without it the deflection of a locked wheel would grow without bound.
// At walking speed and below the tread is damped: its force is that of w + tau w'.
// As the states of machine elements (element_force.hpp) they are eliminated within a step.
#pragma once

#include "mbd_server/forces/force_element.hpp"
#include "mbd_server/forces/tyre_data.hpp"

namespace tandem::mbd {

struct TyreForce {
  Vector3d p = Vector3d::Zero();                                      // point of contact, in the world
  Vector3d along = Vector3d::Zero(), across = along, normal = along;  // axes of the contact
  Vector3d force = Vector3d::Zero();    // along, across and normal to the road [N]
  double aligning = 0, resistance = 0;  // torques about the normal and about the axle [N m]
  Vector6d wrench = Vector6d::Zero();   // on the wheel
  double power = 0;                     // that the road gives the wheel [W]
  double lost = 0;                      // and what the tyre takes besides, less its vertical spring
  double energy = 0;                    // of the vertical spring [J]
  double radius = 0;                    // from the axle to the point of contact [m]
  Eigen::Vector2d w = Eigen::Vector2d::Zero(), w_rate = w;  // deflections of the tread [m]
  Eigen::Vector2d slip = w;                                 // w over the relaxation length [-]
  // Derivatives of the wrench by displacement and velocity of the wheel, as those of ContactForce.
  Matrix6d by_displacement = Matrix6d::Zero(), by_velocity = Matrix6d::Zero();
};

// Throws Error{numerics} where the wheel lies on the road or passes through it, and as plane_under().
TyreForce evaluate(const TyreOnLink& tyre, const State& state, const std::vector<LinkMotion>& links);
// Its force normal to the road alone [N].
double load_on(const TyreOnLink& tyre, const std::vector<LinkMotion>& links);
// Whether one of the four points under a tyre with a road is on that shape of contact.
bool stands_on(const TyreOnLink& tyre, const std::vector<LinkMotion>& links, int shape);

std::shared_ptr<const ForceElement> make_force(TyreOnLink tyre);

}  // namespace tandem::mbd
