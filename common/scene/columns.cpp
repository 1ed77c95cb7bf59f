#include "common/scene/columns.hpp"

#include <algorithm>

#include "common/scene/element_columns.hpp"
#include "common/scene/sensor_columns.hpp"

namespace tandem::scene {

namespace {

void add(std::vector<std::string>& columns, const std::string& quantity, const char* components) {
  for (const char* c = components; *c; ++c) columns.push_back(quantity + "." + *c);
}

void add_contact(std::vector<std::string>& columns, const std::string& body) {
  add(columns, body + ".contact_force", "xyz");
  add(columns, body + ".contact_torque", "xyz");
}

}  // namespace

std::vector<std::string> body_columns(const Scene& scene) {
  std::vector<std::string> columns;
  if (scene.mbd)
    for (const Body& body : scene.mbd->bodies) {
      add(columns, body.name + ".position", "xyz");
      add(columns, body.name + ".orientation", "wxyz");
      add(columns, body.name + ".velocity", "xyz");
      add(columns, body.name + ".angular_velocity", "xyz");
      if (scene.has_particles()) add_contact(columns, body.name);
    }
  if (scene.has_particles()) add_contact(columns, scene.body_name(ground));
  return columns;
}

std::vector<std::string> joint_columns(const Scene& scene) {
  std::vector<std::string> columns;
  if (scene.mbd)
    for (const Joint& joint : scene.mbd->joints) {
      columns.push_back(joint.name + ".q");
      columns.push_back(joint.name + ".rate");
      add(columns, joint.name + ".reaction_force", "xyz");
      add(columns, joint.name + ".reaction_torque", "xyz");
      columns.push_back(joint.name + ".undetermined");
    }
  return columns;
}

std::vector<std::string> all_columns(const Scene& scene) {
  std::vector<std::string> columns = body_columns(scene);
  for (const auto& more : {joint_columns(scene), element_columns(scene), sensor_columns(scene)})
    columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

std::vector<std::string> control_inputs(const Mbd& mbd) {
  std::vector<std::string> names;
  const auto add_input = [&](const std::string& input) {
    if (!input.empty() && std::find(names.begin(), names.end(), input) == names.end()) names.push_back(input);
  };
  for (const Force& force : mbd.forces) {
    if (const auto* actuator = std::get_if<Actuator>(&force)) add_input(actuator->input);
    if (const auto* cylinder = std::get_if<Cylinder>(&force)) add_input(cylinder->input);
    if (const auto* motor = std::get_if<Motor>(&force)) {
      add_input(motor->input);
      if (motor->brake) add_input(motor->brake->input);
    }
  }
  return names;
}

}  // namespace tandem::scene
