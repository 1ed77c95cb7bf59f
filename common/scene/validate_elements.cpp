// Motors, cylinders and tyres.
#include <algorithm>
#include <cmath>
#include <string>

#include "common/scene/motion_function.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

// A signal that has a range, as a function of time.
void validate_range(const Motion& motion, double lowest, double highest, const char* what, double end_time,
                    const std::string& origin, const std::string& path) {
  validate_size(motion, origin, path);
  const MotionFunction function(motion, FunctionOf::force);
  double furthest = 1e-9, at = -1;
  for (const double t : function.samples(0, end_time)) {
    const double value = function.at(t).value, out = std::max(value - highest, lowest - value);
    if (out > furthest) furthest = out, at = t;
  }
  if (at >= 0)
    fail(origin, path,
         std::string("the ") + what + " is " + rounded(function.at(at).value) + " at t = " + rounded(at) +
             " s",
         "give values from " + text(lowest) + " to " + text(highest));
}

void validate_gains(const Gains& gains, bool of_rate, bool limited, const std::string& origin,
                    const std::string& path) {
  if (gains.proportional == 0 && gains.integral == 0 && gains.derivative == 0)
    fail(origin, path, "all gains are 0: nothing follows the target",
         "give a proportional gain, and an integral one where a load must not leave an error");
  if (of_rate && gains.derivative != 0 && gains.filter == 0)
    fail(origin, path + ".derivative", "the derivative of a rate is an acceleration, which is not filtered",
         "add \"filter\": a time constant, or leave out the derivative");
  if (gains.filter != 0 && gains.derivative == 0)
    fail(origin, path + ".filter", "there is no derivative to filter", "leave it out, or add a derivative");
  const bool draws_back = limited && gains.integral != 0;
  if (gains.anti_windup && !draws_back)
    fail(origin, path + ".anti_windup", "no limit can wind up an integral here",
         "leave it out, or give a limit and an integral gain");
  if (draws_back && !gains.anti_windup && gains.proportional == 0)
    fail(origin, path + ".integral", "the limited integral has no time constant to be drawn back with",
         "add \"anti_windup\": a time constant, or a proportional gain");
}

void refuse_gains(const Gains& gains, const std::string& control, const std::string& origin,
                  const std::string& path) {
  if (gains.proportional != 0 || gains.integral != 0 || gains.derivative != 0)
    fail(origin, path, "the control '" + control + "' has no error for them", "leave them out");
}

void validate_hydraulics(const Cylinder& cylinder, const std::string& origin, const std::string& path) {
  const HydraulicData& data = *cylinder.hydraulics;
  if (!cylinder.limits)
    fail(origin, path + ".limits", "the chambers have no length without end stops",
         "add the lower and upper stroke at which the piston meets its end, and a stiffness");
  if (!(data.rod_area < data.bore_area))
    fail(origin, path + ".hydraulics.rod_area",
         text(data.rod_area) + " m2 is not below the bore_area of " + text(data.bore_area) + " m2",
         "the rod is thinner than the bore");
  if (!(data.tank_pressure < data.supply_pressure))
    fail(origin, path + ".hydraulics.tank_pressure",
         text(data.tank_pressure) + " Pa is not below the supply_pressure of " + text(data.supply_pressure) +
             " Pa",
         "oil flows from the supply to the tank");
  const auto check = [&](const std::optional<double>& pressure, const char* key) {
    if (pressure && *pressure < data.cavitation_pressure)
      fail(origin, path + ".hydraulics." + key,
           text(*pressure) + " Pa is below the cavitation_pressure of " + text(data.cavitation_pressure) +
               " Pa",
           "start with a higher pressure");
  };
  check(data.pressure_a, "pressure_a");
  check(data.pressure_b, "pressure_b");
  if (0 < cylinder.limits->lower || 0 > cylinder.limits->upper)
    fail(origin, path + ".limits", "the stroke at the start, 0, is outside",
         "strokes are counted from the length at the start: lower <= 0 <= upper");
}

}  // namespace

void validate_force(const Motor& motor, const Mbd& mbd, double end_time, const std::string& origin,
                    const std::string& path) {
  const Joint& joint = mbd.joints[motor.joint.value];
  require_revolute(joint, mbd, "a motor turns; write a cylinder for a sliding joint", origin,
                   path + ".joint");
  if (joint.motion)
    fail(origin, path + ".joint", "joint '" + joint.name + "' has a motion: no torque can move it",
         "leave out one of the two");
  if (joint.cut)
    fail(origin, path + ".joint", "joint '" + joint.name + "' is cut and has no coordinate",
         "cut another joint of the loop");
  if (motor.torque_speed) {
    validate_arguments(*motor.torque_speed, origin, path + ".torque_speed");
    if (motor.max_torque)
      fail(origin, path + ".max_torque", "torque_speed limits the torque already",
           "leave out one of the two");
  }
  if (motor.control == MotorControl::throttle) {
    if (!motor.torque_speed)
      fail(origin, path + ".control", "a throttle takes a share of torque_speed, which is not given",
           "add torque_speed, or control the speed or the position");
    refuse_gains(motor.gains, "throttle", origin, path + ".gains");
    if (motor.input.empty())
      validate_range(motor.target, -1, 1, "throttle", end_time, origin, path + ".target");
  } else {
    validate_gains(motor.gains, motor.control == MotorControl::speed, motor.max_torque || motor.torque_speed,
                   origin, path + ".gains");
    validate_size(motor.target, origin, path + ".target");
  }
  if (motor.brake && motor.brake->breakaway.value_or(HUGE_VAL) < motor.brake->torque)
    fail(origin, path + ".brake.breakaway",
         text(*motor.brake->breakaway) + " is below the torque of the slipping brake, " +
             text(motor.brake->torque),
         "give that or more");
  if (motor.brake && motor.brake->engaged)
    validate_range(*motor.brake->engaged, 0, 1, "share", end_time, origin, path + ".brake.engaged");
}

void validate_force(const Tyre& tyre, const Mbd& mbd, double, const std::string& origin,
                    const std::string& path) {
  constexpr double least_sine = 0.2;  // of the angle between axle and normal, as the solver needs
  const Joint& joint = mbd.joints[tyre.joint.value];
  require_revolute(joint, mbd, "name the joint about which the wheel turns; its child is the wheel", origin,
                   path + ".joint");
  require_unit(tyre.road_normal, origin, path + ".road_normal");
  if (norm(cross(joint.axis, tyre.road_normal)) < least_sine)
    fail(origin, path + ".joint",
         "the axis " + text(joint.axis) + " of joint '" + joint.name + "' is along the normal of the road, " +
             text(tyre.road_normal),
         "the axle of a wheel that stands is across it");
  const double height = dot(joint.position - tyre.road_point, tyre.road_normal);
  if (tyre.road.empty() && !(height > 0.5 * tyre.radius))
    fail(origin, path + ".road_point",
         "the centre of the wheel, the point of joint '" + joint.name + "', is " + rounded(height) +
             " m above the road, less than half of the radius of " + text(tyre.radius) + " m",
         "give road_point and road_normal of a road below the wheel");
  if (tyre.patch_length > 2 * tyre.radius)
    fail(origin, path + ".patch_length",
         "the tyre touches the road along " + rounded(tyre.patch_length) +
             " m, more than the diameter of the wheel, " + rounded(2 * tyre.radius) + " m",
         "give the length of the patch, a part of the radius");
  if (mbd.start == Start::equilibrium)
    fail(origin, path, "the search for the equilibrium knows no tyres",
         "leave out mbd.start, and let the vehicle come to rest in a run");
}

namespace {

// The farthest point of a bounded shape of a body from the axis of a joint [m].
double reach_from_axis(const Shape& shape, const Body& body, const Joint& joint, const std::string& origin) {
  constexpr int segments = 64;
  const Vec3d centre = joint.child_position.value_or(joint.position);
  double reach = 0;
  for (const Vec3d& p : mesh_of(shape, {}, segments, origin).vertices) {
    const Vec3d in_body = shape.pose.p_WB + shape.pose.q_WB.rotate(p),
                away = body.pose.p_WB + body.pose.q_WB.rotate(in_body) - centre;
    reach = std::max(reach, norm(cross(joint.axis, away)) / norm(joint.axis));
  }
  return reach;
}

// Whether a shape of the ground is a road of the tyre, by name or as the same plane.
bool is_road(const Shape& ground, const Tyre& tyre) {
  if (!tyre.road.empty()) return std::ranges::find(tyre.road, ground.name) != tyre.road.end();
  const auto* plane = std::get_if<PlaneShape>(&ground.geometry);
  if (!plane) return false;
  const Vec3d normal = ground.pose.q_WB.rotate(plane->normal),
              point = ground.pose.p_WB + ground.pose.q_WB.rotate(plane->point);
  return norm(cross(normal, tyre.road_normal)) < 1e-3 && dot(normal, tyre.road_normal) > 0 &&
         std::abs(dot(point - tyre.road_point, normal)) < 1e-3 * tyre.radius;
}

// Refuses a wheel that stands on its road with its tyre and with a shape of contact: both would bear.
void refuse_two_supports(const Scene& scene, const Tyre& tyre, const std::string& origin,
                         const std::string& path) {
  if (!scene.contact) return;
  const Joint& joint = scene.mbd->joints[tyre.joint.value];
  const auto road =
      std::ranges::find_if(scene.contact->ground, [&](const Shape& s) { return is_road(s, tyre); });
  if (road == scene.contact->ground.end() || !may_touch(scene, joint.child, ground)) return;
  const Body& wheel = scene.mbd->bodies[joint.child.value];
  for (const Shape& shape : scene.shapes) {
    if (shape.use != ShapeUse::contact || shape.body != joint.child || !file_of(shape.geometry).empty() ||
        !is_bounded(shape.geometry))
      continue;
    const double reach = reach_from_axis(shape, wheel, joint, origin);
    if (reach < (1 - 1e-6) * tyre.radius) continue;
    fail(origin, path,
         "the tyre and the shape of contact '" + shape.name + "' of its wheel, which reaches " +
             rounded(reach) + " m from the axle, would both stand on '" + road->name + "'",
         "leave one of them out, make the shape smaller than the radius of " + text(tyre.radius) +
             " m, or add ['" + wheel.name + "', 'ground'] to mbd.contact.ignore");
  }
}

}  // namespace

void validate_roads(const Scene& scene, const std::string& origin) {
  if (!scene.mbd) return;
  for (std::size_t i = 0; i < scene.mbd->forces.size(); ++i) {
    const auto* tyre = std::get_if<Tyre>(&scene.mbd->forces[i]);
    if (!tyre) continue;
    for (std::size_t k = 0; k < tyre->road.size(); ++k) {
      const std::string path = element(element("mbd.forces", i) + ".road", k), &name = tyre->road[k];
      if (!scene.contact)
        fail(origin, path, "the scene has no mbd.contact, whose ground has the roads",
             "add mbd.contact with the shape '" + name + "' in its ground, or leave out road");
      const std::vector<Shape>& shapes = scene.contact->ground;
      const auto shape = std::ranges::find(shapes, name, &Shape::name);
      if (shape == shapes.end()) {
        std::vector<std::string> names;
        for (const Shape& known : shapes) names.push_back(known.name);
        fail(origin, path, "unknown name '" + name + "'", suggest_name(name, names, "mbd.contact.ground"));
      }
      if (!std::holds_alternative<PlaneShape>(shape->geometry) &&
          !std::holds_alternative<MeshShape>(shape->geometry) &&
          !std::holds_alternative<HeightFieldShape>(shape->geometry))
        fail(origin, path, "'" + name + "' is a " + name_of(shape->geometry),
             "roads are planes, meshes and height fields");
      if (std::ranges::count(tyre->road, name) > 1)
        fail(origin, path, "'" + name + "' is given twice", "leave one of them out");
    }
    refuse_two_supports(scene, *tyre, origin, element("mbd.forces", i));
  }
}

void validate_force(const Cylinder& cylinder, const Mbd&, double end_time, const std::string& origin,
                    const std::string& path) {
  if (cylinder.body_a == cylinder.body_b)
    fail(origin, path + ".body_b", "both ends of '" + cylinder.name + "' are on the same body",
         "a cylinder acts between two bodies, or a body and the ground");
  if (cylinder.point_a == cylinder.point_b)
    fail(origin, path + ".point_b",
         "both ends are at " + text(cylinder.point_b) + ": the force has no direction",
         "move one of the points");
  if (cylinder.friction && cylinder.friction->breakaway)
    fail(origin, path + ".friction.breakaway", "stiction is that of joint coordinates; a cylinder has none",
         "give slip, or the friction to a prismatic joint along the cylinder");
  const double length = norm(cylinder.point_b - cylinder.point_a);
  if (cylinder.limits) {
    if (!(cylinder.limits->lower < cylinder.limits->upper))
      fail(origin, path + ".limits.upper",
           text(cylinder.limits->upper) + " is not above the lower limit of " + text(cylinder.limits->lower),
           "lower < upper");
    if (cylinder.limits->restitution)
      fail(origin, path + ".limits.restitution", "the end stops of a cylinder have a damping",
           "give damping, or limits with a restitution at a prismatic joint");
    if (!(cylinder.limits->lower > -length))
      fail(origin, path + ".limits.lower",
           "at a stroke of " + text(cylinder.limits->lower) + " m the ends of '" + cylinder.name +
               "', which start " + rounded(length) + " m apart, meet",
           "give more than " + rounded(-length) + " m");
  }
  const bool of_stroke = cylinder.control == CylinderControl::stroke;
  if (cylinder.max_force && !of_stroke)
    fail(origin, path + ".max_force", "only a controlled stroke has a largest force",
         "leave it out, or write \"control\": \"stroke\"");
  if (cylinder.hydraulics && cylinder.control != CylinderControl::valve)
    fail(origin, path + ".hydraulics", "the control is not that of the valve",
         "write \"control\": \"valve\", or leave out the hydraulics");
  if (of_stroke) {
    validate_gains(cylinder.gains, false, cylinder.max_force.has_value(), origin, path + ".gains");
    validate_size(cylinder.target, origin, path + ".target");
  } else if (cylinder.control == CylinderControl::force) {
    refuse_gains(cylinder.gains, "force", origin, path + ".gains");
    validate_size(cylinder.target, origin, path + ".target");
  } else {
    refuse_gains(cylinder.gains, "valve", origin, path + ".gains");
    if (!cylinder.hydraulics)
      fail(origin, path + ".control", "there is no valve without hydraulics", "add \"hydraulics\"");
    validate_hydraulics(cylinder, origin, path);
    if (cylinder.input.empty())
      validate_range(cylinder.target, -1, 1, "opening", end_time, origin, path + ".target");
  }
}

}  // namespace tandem::scene
