// Motors and cylinders of the scene as elements of the model, with their states of first order.
#include <algorithm>

#include "common/scene/columns.hpp"
#include "mbd_server/forces/drive.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/forces/hydraulics.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {

int add_first_order_state(Model& model, double start, double scale, const std::string& what) {
  const Eigen::Index n = model.first_states.size();
  model.first_states.conservativeResize(n + 1);
  model.state_scale.conservativeResize(n + 1);
  model.first_states[n] = start;
  model.state_scale[n] = scale;
  model.state_names.push_back(what);
  return static_cast<int>(n);
}

namespace {

int index_of(const std::string& input, const std::vector<std::string>& inputs) {
  return static_cast<int>(std::find(inputs.begin(), inputs.end(), input) - inputs.begin());
}

// A table of what a coordinate should do is as smooth as one of a prescribed coordinate: it begins and ends
// at rest, since the derivative of the error would kick where its slope jumps.
enum class SignalOf { coordinate, share };

Signal signal(const scene::Motion& motion, const std::string& input, const std::vector<std::string>& inputs,
              SignalOf of, Model& model) {
  if (!input.empty()) return {.drive = none, .input = index_of(input, inputs)};
  const auto* table = std::get_if<scene::TableMotion>(&motion);
  const bool smooth =
      of == SignalOf::coordinate && table && table->interpolation == scene::Interpolation::monotone;
  model.drives.emplace_back(motion, smooth ? scene::FunctionOf::coordinate : scene::FunctionOf::force);
  model.drive_is_force.push_back(false);
  return {.drive = static_cast<int>(model.drives.size()) - 1, .input = none};
}

// An input that gives a share of something.
void limit_input(const Signal& signal, double lowest, const std::string& of, Model& model) {
  if (signal.input != none) model.input_ranges.push_back({signal.input, lowest, 1, of});
}

Drive controlled(const scene::Gains& gains, Drive::Of of) {
  Drive drive;
  drive.of = of;
  drive.proportional = gains.proportional;
  drive.integral = gains.integral;
  drive.derivative = gains.derivative;
  drive.filter = gains.filter;
  if (gains.integral != 0)
    drive.anti_windup =
        gains.anti_windup.value_or(gains.proportional > 0 ? gains.proportional / gains.integral : 1);
  return drive;
}

void add_state(Element& element, double start, double scale, const std::string& what, Model& model) {
  const int index = add_first_order_state(model, start, scale, what + " of " + element.name);
  if (element.states++ == 0) element.state = index;
}

// The scale of an integral is that of its quantity in a second, that of a filtered error that of the
// quantity.
void add_states(Element& element, const Drive& drive, double scale, Model& model) {
  if (drive.of == Drive::Of::force) return;
  if (drive.has_integral()) add_state(element, 0, scale, "integral", model);
  if (drive.has_filter()) add_state(element, 0, scale, "filtered error", model);
}

}  // namespace

void place_element(const scene::Motor& motor, int account, const std::vector<std::string>& inputs,
                   Model& model) {
  Element element;
  element.account = account;
  element.name = "motor \"" + motor.name + "\"";
  element.link = model.joints.at(motor.joint.value).coordinate_link;
  element.signal =
      signal(motor.target, motor.input, inputs,
             motor.control == scene::MotorControl::throttle ? SignalOf::share : SignalOf::coordinate, model);
  Drive drive;
  if (motor.control == scene::MotorControl::throttle)
    limit_input(element.signal, -1, "the throttle of " + element.name, model);
  else
    drive = controlled(motor.gains,
                       motor.control == scene::MotorControl::speed ? Drive::Of::rate : Drive::Of::position);
  drive.gear = motor.gear_ratio;
  if (motor.torque_speed) drive.curve = ForceLaw(0, motor.torque_speed);
  if (motor.max_torque) drive.limit = motor.gear_ratio * *motor.max_torque;
  element.rotor = motor.gear_ratio * motor.gear_ratio * motor.rotor_inertia;
  if (motor.brake) {
    Signal share;
    if (motor.brake->engaged || !motor.brake->input.empty())
      share = signal(motor.brake->engaged.value_or(scene::ConstantMotion{1, 0}), motor.brake->input, inputs,
                     SignalOf::share, model);
    limit_input(share, 0, "the brake of " + element.name, model);
    const scene::Friction friction{motor.brake->torque, motor.brake->slip, motor.brake->breakaway};
    if (friction.breakaway) {
      JointForce& force = model.joint_forces.emplace_back();
      force.account = account, force.brake = true;
      force.link = element.link, force.friction = friction, force.share = share;
      add_stiction(model);
    } else {
      element.friction = friction, element.brake = share;
    }
  }
  add_states(element, drive, 1, model);
  element.law = std::make_shared<Drive>(drive);
  model.forces.push_back(make_force(std::move(element)));
}

void place_element(const Placement& placement, const scene::Cylinder& cylinder, int account,
                   const std::vector<std::string>& inputs, Model& model) {
  Element element;
  element.account = account;
  element.name = "cylinder \"" + cylinder.name + "\"";
  element.a = placement.point(model, cylinder.body_a, cylinder.point_a);
  element.b = placement.point(model, cylinder.body_b, cylinder.point_b);
  element.length = norm(cylinder.point_b - cylinder.point_a);
  element.signal = signal(
      cylinder.target, cylinder.input, inputs,
      cylinder.control == scene::CylinderControl::stroke ? SignalOf::coordinate : SignalOf::share, model);
  element.damping = cylinder.damping;
  element.friction = cylinder.friction;
  element.ends = cylinder.limits;
  if (cylinder.control == scene::CylinderControl::valve) {
    const scene::HydraulicData& data = *cylinder.hydraulics;
    Hydraulics oil;
    oil.area_a = data.bore_area, oil.area_b = data.bore_area - data.rod_area;
    oil.volume = data.dead_volume;
    oil.lower = cylinder.limits->lower, oil.upper = cylinder.limits->upper;
    oil.modulus = data.bulk_modulus;
    oil.supply = data.supply_pressure, oil.tank = data.tank_pressure;
    if (data.pump_flow) oil.pump = *data.pump_flow;
    oil.flow = data.valve_flow, oil.drop = data.valve_drop, oil.laminar = data.laminar_drop;
    oil.leakage = data.leakage;
    oil.cavitation = data.cavitation_pressure;
    add_state(element, data.pressure_a.value_or(oil.tank), oil.supply, "pressure in chamber a", model);
    add_state(element, data.pressure_b.value_or(oil.tank), oil.supply, "pressure in chamber b", model);
    limit_input(element.signal, -1, "the valve of " + element.name, model);
    element.law = std::make_shared<Hydraulics>(oil);
  } else {
    Drive drive;
    if (cylinder.control == scene::CylinderControl::stroke)
      drive = controlled(cylinder.gains, Drive::Of::position);
    if (cylinder.max_force) drive.limit = *cylinder.max_force;
    add_states(element, drive, model.size, model);
    element.law = std::make_shared<Drive>(drive);
  }
  model.forces.push_back(make_force(std::move(element)));
}

}  // namespace tandem::mbd
