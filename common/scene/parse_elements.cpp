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

HydraulicData parse_hydraulics(const Node& node) {
  HydraulicData data;
  node.read("bore_area", data.bore_area);
  node.read("rod_area", data.rod_area);
  node.read("dead_volume", data.dead_volume);
  node.read("bulk_modulus", data.bulk_modulus);
  node.read("supply_pressure", data.supply_pressure);
  node.read("tank_pressure", data.tank_pressure);
  node.read("pump_flow", data.pump_flow);
  node.read("valve_flow", data.valve_flow);
  node.read("valve_drop", data.valve_drop);
  node.read("laminar_drop", data.laminar_drop);
  node.read("leakage", data.leakage);
  node.read("pressure_a", data.pressure_a);
  node.read("pressure_b", data.pressure_b);
  node.read("cavitation_pressure", data.cavitation_pressure);
  return data;
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
  node.read("max_torque", motor.max_torque);
  motor.torque_speed = parse_table(node, "torque_speed");
  node.read("gear_ratio", motor.gear_ratio);
  node.read("rotor_inertia", motor.rotor_inertia);
  if (node.has("brake")) motor.brake = parse_brake(node.at("brake"), format);
  return motor;
}

Force parse_cylinder(const Node& node, const Names& bodies, const std::string& format) {
  Cylinder cylinder;
  node.read("name", cylinder.name);
  cylinder.body_a = read_body(node, "body_a", bodies);
  cylinder.body_b = read_body(node, "body_b", bodies);
  node.read("point_a", cylinder.point_a);
  node.read("point_b", cylinder.point_b);
  const auto control = node.value().at("control").get<std::string>();
  cylinder.control = control == "stroke"  ? CylinderControl::stroke
                     : control == "force" ? CylinderControl::force
                                          : CylinderControl::valve;
  read_target(node, format, cylinder);
  cylinder.gains = parse_gains(node);
  node.read("max_force", cylinder.max_force);
  if (node.has("hydraulics")) cylinder.hydraulics = parse_hydraulics(node.at("hydraulics"));
  node.read("damping", cylinder.damping);
  if (node.has("friction")) cylinder.friction = parse_friction(node.at("friction"));
  if (node.has("limits")) cylinder.limits = parse_limits(node.at("limits"));
  return cylinder;
}

}  // namespace tandem::scene
