// The forces of a machine; motors, cylinders and tyres are in validate_elements.cpp.
#include <algorithm>
#include <cmath>

#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

// A law is given once: by a number or by a table.
void validate_law(const std::optional<ForceTable>& table, double number, const char* key,
                  const char* number_key, const std::string& origin, const std::string& path) {
  if (!table) return;
  if (number != 0)
    fail(origin, path + "." + key, std::string("there is a ") + number_key + " as well",
         "give one of the two");
  validate_arguments(*table, origin, path + "." + key);
}

void validate_force(const SpringDamper& spring, const Mbd&, double, const std::string& origin,
                    const std::string& path) {
  if (spring.body_a == spring.body_b)
    fail(origin, path + ".body_b", "both ends of '" + spring.name + "' are on the same body",
         "a spring acts between two bodies, or a body and the ground");
  if (spring.point_a == spring.point_b)
    fail(origin, path + ".point_b",
         "both ends are at " + text(spring.point_b) + ": the force has no direction",
         "move one of the points");
  validate_law(spring.table, spring.stiffness, "table", "stiffness", origin, path);
  validate_law(spring.damping_table, spring.damping, "damping_table", "damping", origin, path);
}

void validate_force(const RotationalSpringDamper& spring, const Mbd& mbd, double, const std::string& origin,
                    const std::string& path) {
  require_revolute(mbd.joints[spring.joint.value], mbd,
                   "a rotational_spring_damper turns about the axis of a revolute joint", origin,
                   path + ".joint");
  validate_law(spring.table, spring.stiffness, "table", "stiffness", origin, path);
  validate_law(spring.damping_table, spring.damping, "damping_table", "damping", origin, path);
}

void validate_force(const Bushing& bushing, const Mbd&, double, const std::string& origin,
                    const std::string& path) {
  if (bushing.body_a == bushing.body_b)
    fail(origin, path + ".body_b", "both ends of '" + bushing.name + "' are on the same body",
         "a bushing connects two bodies, or a body and the ground");
}

void validate_over(const std::optional<JointFunction>& over, const Mbd& mbd, const std::string& origin,
                   const std::string& path) {
  if (!over) return;
  const Joint& joint = mbd.joints[over->joint.value];
  if (joint.type != JointType::revolute && joint.type != JointType::prismatic &&
      joint.type != JointType::screw)
    fail(origin, path + ".over.joint", "joint '" + joint.name + "' has no coordinate of its own",
         "name a revolute, prismatic or screw joint");
  if (joint.cut)
    fail(origin, path + ".over.joint", "joint '" + joint.name + "' is cut and has no coordinate",
         "cut another joint of the loop");
  validate_curve(over->table.arguments, over->table.values, over->period, true, origin, path + ".over");
}

void validate_force(const BodyLoad& load, const Mbd& mbd, double, const std::string& origin,
                    const std::string& path) {
  require_unit(load.direction, origin, path + ".direction");
  validate_over(load.over, mbd, origin, path);
  validate_size(load.size, origin, path + ".size");
}

void validate_force(const Actuator& actuator, const Mbd& mbd, double, const std::string& origin,
                    const std::string& path) {
  const Joint& joint = mbd.joints[actuator.joint.value];
  if (joint.type != JointType::revolute && joint.type != JointType::prismatic)
    fail(origin, path + ".joint", "joint '" + joint.name + "' is neither revolute nor prismatic",
         "an actuator drives one coordinate");
  if (joint.motion)
    fail(origin, path + ".joint", "joint '" + joint.name + "' has a motion: no torque can move it",
         "leave out one of the two");
  validate_over(actuator.over, mbd, origin, path);
  validate_size(actuator.size, origin, path + ".size");
}

// The rope leaves its drum along a tangent, at a point that does not turn with it.
void validate_drum(const Rope& rope, const Mbd& mbd, const std::string& origin, const std::string& path) {
  constexpr double least_cosine = 0.985;  // 10 degrees
  const Joint& joint = mbd.joints[rope.drum->value];
  require_revolute(joint, mbd, "name the joint about which the drum turns", origin, path + ".drum");
  if (joint.cut)
    fail(origin, path + ".drum", "joint '" + joint.name + "' is cut and has no coordinate",
         "cut another joint of the loop");
  const auto name = [&](BodyId body) {
    return body == ground ? std::string("ground") : mbd.bodies[body.value].name;
  };
  if (rope.points.front().body != joint.parent)
    fail(origin, element(path + ".points", 0) + ".body",
         "the rope leaves the drum at a point of '" + name(rope.points.front().body) +
             "', and the parent of joint '" + joint.name + "' is '" + name(joint.parent) + "'",
         "name the parent, since that point does not turn with the drum");
  const DrumLead lead = drum_lead(rope, mbd.joints);
  if (!(norm(lead.arm) > 1e-9))
    fail(origin, element(path + ".points", 0) + ".point", "the rope leaves the drum on its axis",
         "give the point at which the rope leaves the surface: its distance from the axis is the radius");
  if (!(lead.cosine >= least_cosine))
    fail(origin, element(path + ".points", 0) + ".point",
         "the rope leaves the drum at " +
             rounded(std::acos(std::min(1.0, lead.cosine)) * 180 / std::numbers::pi) +
             " degrees to its surface",
         "give the point at which the rope touches the drum as a tangent, within 10 degrees");
}

void validate_force(const Rope& rope, const Mbd& mbd, double, const std::string& origin,
                    const std::string& path) {
  for (std::size_t k = 1; k < rope.points.size(); ++k) {
    if (rope.points[k].point == rope.points[k - 1].point)
      fail(origin, element(path + ".points", k) + ".point",
           "two points in succession are at " + text(rope.points[k].point) +
               ": the rope has no direction there",
           "move one of the points, or leave it out");
  }
  const BodyId first = rope.points.front().body;
  if (std::all_of(rope.points.begin(), rope.points.end(),
                  [&](const RopePoint& point) { return point.body == first; }))
    fail(origin, path + ".points", "all points of rope '" + rope.name + "' are on the same body",
         "name points of two bodies at least, or of a body and the ground");
  if (rope.drum) validate_drum(rope, mbd, origin, path);
}

}  // namespace

void validate_forces(const Mbd& mbd, double end_time, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.forces.size(); ++i)
    std::visit(
        [&](const auto& force) {
          const std::string path = element("mbd.forces", i);
          if constexpr (requires { force.validate(mbd, origin, path); })
            force.validate(mbd, origin, path);
          else
            validate_force(force, mbd, end_time, origin, path);
        },
        mbd.forces[i]);
}

}  // namespace tandem::scene
