// Motors and cylinders.
#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

Gains parse_gains(const Node& node) {
  Gains gains;
  if (!node.has("gains")) return gains;
  const Node from = node.at("gains");
  from.read("proportional", gains.proportional);
  from.read("integral", gains.integral);
  from.read("derivative", gains.derivative);
  from.read("filter", gains.filter);
  from.read("anti_windup", gains.anti_windup);
  return gains;
}

// A target as a function of time, or the name of a control input.
template <class Element>
void read_target(const Node& node, const std::string& format, Element& element) {
  if (node.has("target") == node.has("input"))
    node.fail("the " + node.type() + " has " +
                  (node.has("target") ? "a target and an input" : "neither target nor input"),
              "give one of them: a function of time, or the name of a control input");
  node.read("input", element.input);
  if (node.has("target")) element.target = parse_motion(node.at("target"), format);
}

Brake parse_brake(const Node& node, const std::string& format) {
  Brake brake;
  node.read("torque", brake.torque);
  node.read("slip", brake.slip);
  node.read("breakaway", brake.breakaway);
  if (node.has("slip") == node.has("breakaway"))
    node.fail(std::string("the brake has ") +
                  (node.has("slip") ? "a slip and a breakaway" : "neither slip nor breakaway"),
              "give one of them: with slip the joint creeps under a load, with breakaway it stays at rest");
  node.read("input", brake.input);
  if (node.has("engaged")) brake.engaged = parse_motion(node.at("engaged"), format);
  if (brake.engaged && !brake.input.empty())
    node.fail("engaged", "the brake has an input as well", "leave out one of the two");
  return brake;
}

}  // namespace

Force parse_motor(const Node& node, const Names& joints, const std::string& format) {
  Motor motor;
  node.read("name", motor.name);
  motor.joint = JointId{node.resolve("joint", joints, "joints")};
  const auto control = node.value().at("control").get<std::string>();
  motor.control = control == "speed"      ? MotorControl::speed
                  : control == "position" ? MotorControl::position
                                          : MotorControl::throttle;
  read_target(node, format, motor);
  motor.gains = parse_gains(node);
  read_keys(node, motor);
  motor.torque_speed = parse_table(node, "torque_speed");
  if (node.has("brake")) motor.brake = parse_brake(node.at("brake"), format);
  return motor;
}

Force parse_cylinder(const Node& node, const Names& bodies, const std::string& format) {
  Cylinder cylinder;
  node.read("name", cylinder.name);
  cylinder.body_a = read_body(node, "body_a", bodies);
  cylinder.body_b = read_body(node, "body_b", bodies);
  read_keys(node, cylinder);
  const auto control = node.value().at("control").get<std::string>();
  cylinder.control = control == "stroke"  ? CylinderControl::stroke
                     : control == "force" ? CylinderControl::force
                                          : CylinderControl::valve;
  read_target(node, format, cylinder);
  cylinder.gains = parse_gains(node);
  if (node.has("hydraulics")) read_keys(node.at("hydraulics"), cylinder.hydraulics.emplace());
  if (node.has("friction")) cylinder.friction = parse_friction(node.at("friction"));
  if (node.has("limits")) cylinder.limits = parse_limits(node.at("limits"));
  return cylinder;
}

}  // namespace tandem::scene
