#include <Eigen/Eigenvalues>
#include <vector>

#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

void validate_inertia(const Body& body, const std::string& origin, const std::string& path) {
  const auto& I = body.inertia;
  Eigen::Matrix3d matrix;
  matrix << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix, Eigen::EigenvaluesOnly)
          .eigenvalues();  // ascending
  const std::string found =
      "the principal moments are " + rounded(Vec3d{moments[0], moments[1], moments[2]}) + " kg m2; ";
  // A moment that is zero but for rounding is zero.
  constexpr double rounding = 1e-12;
  if (!(moments[0] > rounding * moments[2]))
    fail(origin, path, found + "all must be positive", "check xx, yy, zz, xy, xz, yz and their units");
  // Each moment is a sum of two of the three second moments of the mass. Decimals of thin plates round.
  constexpr double tolerance = 1e-6;
  if (moments[2] > (1 + tolerance) * (moments[0] + moments[1]))
    fail(origin, path, found + "the largest exceeds the sum of the others",
         "no rigid body has such an inertia");
}

void validate_bodies(const Mbd& mbd, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.bodies.size(); ++i) {
    const Body& body = mbd.bodies[i];
    const std::string path = element("mbd.bodies", i);
    validate_inertia(body, origin, path + ".inertia");
    require_unit(body.pose.q_WB, origin, path + ".orientation");
  }
}

void validate_motion(const Joint& joint, const std::string& origin, const std::string& path) {
  if (joint.rate != 0)
    fail(origin, path, "the joint has both a motion and a rate of " + text(joint.rate),
         "leave out the rate: the motion gives it");
  const auto* table = std::get_if<TableMotion>(&*joint.motion);
  if (!table) return;
  if (table->times.size() != table->values.size())
    fail(origin, path + ".values",
         std::to_string(table->values.size()) + " values for " + std::to_string(table->times.size()) +
             " times",
         "give one value for each time");
  for (std::size_t k = 1; k < table->times.size(); ++k)
    if (!(table->times[k] > table->times[k - 1]))
      fail(origin, element(path + ".times", k),
           text(table->times[k]) + " s does not come after " + text(table->times[k - 1]) + " s",
           "times must increase");
}

// Bodies and joints make a tree that grows from the ground.
void validate_tree(const Mbd& mbd, const std::string& origin) {
  std::vector<const Joint*> joint_of(mbd.bodies.size(), nullptr);
  for (std::size_t i = 0; i < mbd.joints.size(); ++i) {
    const Joint& joint = mbd.joints[i];
    const std::string path = element("mbd.joints", i), child = mbd.bodies[joint.child.value].name;
    if (joint.parent == joint.child)
      fail(origin, path + ".child", "'" + child + "' is parent and child of one joint",
           "a joint connects two bodies");
    const Joint*& own = joint_of[joint.child.value];
    if (own)
      fail(origin, path + ".child", "'" + child + "' is already the child of joint '" + own->name + "'",
           "closed loops need cut joints, which are not yet supported");
    own = &joint;
    std::size_t steps = 0;
    for (BodyId body = joint.parent; body != ground && joint_of[body.value];
         body = joint_of[body.value]->parent)
      if (++steps > mbd.bodies.size() || body == joint.child)
        fail(origin, path + ".parent",
             "'" + child + "' hangs on itself: " + joint.name + " closes a circle of joints",
             "start each chain of joints at the ground or at a free body");
  }

  for (std::size_t i = 0; i < mbd.bodies.size(); ++i) {
    const Body& body = mbd.bodies[i];
    const Joint* own = joint_of[i];
    if (!own || own->type == JointType::free) continue;
    const bool turns = norm(body.twist.w_WB) > 0;
    if (turns || norm(body.twist.v_WB) > 0)
      fail(origin, element("mbd.bodies", i) + (turns ? ".angular_velocity" : ".velocity"),
           "'" + body.name + "' gets its velocity from joint '" + own->name + "'",
           "leave it out; revolute and prismatic joints have a rate");
  }
}

void validate_joints(const Mbd& mbd, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.joints.size(); ++i) {
    const Joint& joint = mbd.joints[i];
    const std::string path = element("mbd.joints", i);
    require_unit(joint.axis, origin, path + ".axis");
    if (joint.motion) validate_motion(joint, origin, path + ".motion");
  }
  validate_tree(mbd, origin);
}

void validate_force(const SpringDamper& spring, const Mbd&, const std::string& origin,
                    const std::string& path) {
  if (spring.body_a == spring.body_b)
    fail(origin, path + ".body_b", "both ends of '" + spring.name + "' are on the same body",
         "a spring acts between two bodies, or a body and the ground");
  if (spring.point_a == spring.point_b)
    fail(origin, path + ".point_b",
         "both ends are at " + text(spring.point_b) + ": the force has no direction",
         "move one of the points");
}

void validate_force(const RotationalSpringDamper& spring, const Mbd& mbd, const std::string& origin,
                    const std::string& path) {
  const Joint& joint = mbd.joints[spring.joint.value];
  if (joint.type != JointType::revolute)
    fail(origin, path + ".joint", "joint '" + joint.name + "' is not revolute",
         "a rotational_spring_damper turns about the axis of a revolute joint");
}

}  // namespace

void validate_mbd(const Mbd& mbd, double window, const std::string& origin) {
  validate_bodies(mbd, origin);
  validate_joints(mbd, origin);
  for (std::size_t i = 0; i < mbd.forces.size(); ++i)
    std::visit([&](const auto& spring) { validate_force(spring, mbd, origin, element("mbd.forces", i)); },
               mbd.forces[i]);
  if (mbd.integrator.step && *mbd.integrator.step > window)
    fail(origin, "mbd.integrator.step",
         "the step of " + text(*mbd.integrator.step) + " s is longer than the window of " + text(window) +
             " s",
         "leave it out for one step per window");
}

}  // namespace tandem::scene
