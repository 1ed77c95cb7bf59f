// The springs of friction and of rolling friction from step to step: where their ends are before a step, and
// how they follow what slips in it. Changes the springs of the points, and nothing else.
#pragma once

#include "mbd_server/contact/contact_force.hpp"

namespace tandem::mbd {

// Sets the directions of the rolling spring, given in the world, on the two links.
void set_rolling_spring(const Vector3d& on_a, const Vector3d& on_b, const LinkMotion& a, const LinkMotion& b,
                        RollingSpring& spring);

// Before a step of length h, moves the ends of the springs of friction of round surfaces to where the point
// of contact will be in the middle of the step, and keeps their stretch. The ends are in the two bodies; a
// spin about the normal moves them past each other where the point of contact is elsewhere, which is no
// sliding. Over the step this cancels.
void aim_springs(const Model& model, const std::vector<LinkMotion>& links, double h,
                 std::vector<ContactPoint>& points);
// The same for the directions of the springs of rolling friction: each turns with the spin of its body where
// it is not along the normal, which is no rolling. In the middle of the step they are along the normal as
// seen from the body that spins, or from between both.
void aim_rolling_springs(const Model& model, const std::vector<LinkMotion>& links, double h,
                         std::vector<ContactPoint>& points);

// After a step that ended with the force f, moves the ends of the spring of friction where it slides: to the
// stretch that has the friction with which the step ended, without its damping. Returns the energy of the
// spring [J].
double move_spring(const Model& model, const std::vector<LinkMotion>& links, const ContactForce& f,
                   ContactPoint& point);
// The same for the spring of rolling friction.
double move_rolling_spring(const Model& model, const std::vector<LinkMotion>& links, const ContactForce& f,
                           ContactPoint& point);

}  // namespace tandem::mbd
