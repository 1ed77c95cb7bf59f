#include "common/scene/element_columns.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "common/overloaded.hpp"

namespace tandem::scene {
namespace {

using Source = ElementOfScene::Source;

struct ChannelFacts {
  const char *name, *unit, *meaning;
};
constexpr std::array channels{
#define ELEMENT_CHANNEL(identifier, name, unit, meaning) ChannelFacts{name, unit, meaning},
#include "common/scene/element_channels.def"
#undef ELEMENT_CHANNEL
};

const ChannelFacts& facts(Channel channel) {
  return channels[static_cast<std::size_t>(channel)];
}

// Adds columns to one element.
class Columns {
 public:
  explicit Columns(ElementOfScene& element) : element_(element) {}

  void add(std::initializer_list<Channel> list) {
    for (const Channel channel : list) add_part(channel, 0, "");
  }
  void add_axes(Channel channel) {
    for (int axis = 0; axis < 3; ++axis) add_part(channel, axis, std::string(".") + "xyz"[axis]);
  }
  void add_part(Channel channel, int part, const std::string& ending) {
    element_.columns.push_back({channel, part, element_.name + "." + facts(channel).name + ending});
  }
  // Force or torque on a coordinate, with its rate.
  void add_effort(bool rotates) {
    if (rotates)
      add({Channel::torque, Channel::speed});
    else
      add({Channel::force, Channel::velocity});
  }
  void add_losses(bool any) {
    if (any) add({Channel::loss_power, Channel::loss_energy});
  }

 private:
  ElementOfScene& element_;
};

bool rotates(const Joint& joint) {
  return joint.type != JointType::prismatic;
}

const char* kind_of(CouplerType type) {
  switch (type) {
    case CouplerType::gear:
      return "gear";
    case CouplerType::rack_and_pinion:
      return "rack_and_pinion";
    case CouplerType::belt:
      return "belt";
    case CouplerType::linear:
      return "linear";
    case CouplerType::cam:
      return "cam";
  }
  return "coupler";
}

const char* kind_of(const Force& force) {
  return std::visit(
      Overloaded{[](const BodyLoad& f) { return f.kind == BodyLoad::Kind::force ? "force" : "torque"; },
                 [](const auto& f) { return f.type; }},
      force);
}

bool any(const std::array<double, 36>& matrix) {
  return std::ranges::any_of(matrix, [](double value) { return value != 0; });
}

void add_columns(const Joint& joint, Columns& columns) {
  if (joint.motion) {
    columns.add_effort(rotates(joint));
    columns.add({Channel::power, Channel::energy});
  }
  columns.add_losses(joint.damping != 0 || joint.friction || joint.limits);
}

void add_columns(const Coupler& coupler, const Mbd& mbd, Columns& columns) {
  std::vector<CoupledJoint> terms = coupler.terms;
  if (terms.empty()) terms = {{.joint = coupler.joint_a}, {.joint = coupler.joint_b}};
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const Joint& joint = mbd.joints[terms[k].joint.value];
    const bool turns =
        joint.type == JointType::cylindrical ? terms[k].coordinate == JointCoordinate::angle : rotates(joint);
    columns.add_part(turns ? Channel::torque : Channel::force, static_cast<int>(k), "." + joint.name);
  }
  columns.add({Channel::power});
}

void add_columns(const Motor& motor, Columns& columns) {
  columns.add({Channel::torque, Channel::speed, Channel::power, Channel::energy});
  columns.add({motor.control == MotorControl::speed      ? Channel::target_speed
               : motor.control == MotorControl::position ? Channel::target_angle
                                                         : Channel::throttle});
  if (motor.brake) columns.add({Channel::brake_torque});
  columns.add_losses(motor.brake.has_value());
}

void add_columns(const Cylinder& cylinder, Columns& columns) {
  columns.add({Channel::force, Channel::stroke, Channel::velocity, Channel::power, Channel::energy});
  if (cylinder.control == CylinderControl::stroke) columns.add({Channel::target_stroke});
  if (cylinder.hydraulics)
    columns.add({Channel::opening, Channel::pressure_a, Channel::pressure_b, Channel::flow_a, Channel::flow_b,
                 Channel::supply_power, Channel::supply_energy});
  if (cylinder.hydraulics || cylinder.limits) columns.add({Channel::stored_energy});
  columns.add_losses(cylinder.damping != 0 || cylinder.friction || cylinder.limits || cylinder.hydraulics);
}

void add_columns(const Force& force, const Mbd& mbd, Columns& columns) {
  std::visit(
      Overloaded{[&](const SpringDamper& f) {
                   columns.add({Channel::force, Channel::length, Channel::velocity, Channel::power,
                                Channel::stored_energy});
                   columns.add_losses(f.damping != 0 || f.damping_table);
                 },
                 [&](const RotationalSpringDamper& f) {
                   columns.add({Channel::torque, Channel::speed, Channel::power, Channel::stored_energy});
                   columns.add_losses(f.damping != 0 || f.damping_table);
                 },
                 [&](const Bushing& f) {
                   columns.add_axes(Channel::force);
                   columns.add_axes(Channel::torque);
                   columns.add({Channel::power, Channel::stored_energy});
                   columns.add_losses(any(f.damping));
                 },
                 [&](const BodyLoad& f) {
                   columns.add({f.kind == BodyLoad::Kind::force ? Channel::force : Channel::torque,
                                Channel::power, Channel::energy});
                 },
                 [&](const Actuator& f) {
                   columns.add_effort(rotates(mbd.joints[f.joint.value]));
                   columns.add({Channel::power, Channel::energy});
                 },
                 [&](const Rope& f) {
                   columns.add({Channel::tension, Channel::length, Channel::slack, Channel::power,
                                Channel::stored_energy});
                   columns.add_losses(f.damping != 0);
                 },
                 [&](const Tyre&) {
                   columns.add_axes(Channel::force);
                   columns.add({Channel::slip, Channel::slip_angle, Channel::aligning_torque,
                                Channel::loaded_radius, Channel::power, Channel::stored_energy});
                   columns.add_losses(true);
                 },
                 [&](const Motor& f) { add_columns(f, columns); },
                 [&](const Cylinder& f) { add_columns(f, columns); },
                 [&](const auto& f) {
                   for (const Channel channel : f.channels()) columns.add({channel});
                 }},
      force);
}

void add_contact_columns(Columns& columns) {
  columns.add_axes(Channel::force);
  columns.add_axes(Channel::torque);
  columns.add_axes(Channel::friction);
  columns.add({Channel::normal_force, Channel::depth, Channel::points});
  columns.add_axes(Channel::centre);
  columns.add({Channel::power, Channel::stored_energy, Channel::loss_energy});
}

// Whether any of the items has this name.
template <class Items>
bool has(const Items& items, const std::string& name) {
  return std::ranges::any_of(items, [&](const auto& item) { return item.name == name; });
}

}  // namespace

const char* name(Channel channel) {
  return facts(channel).name;
}
const char* unit(Channel channel) {
  return facts(channel).unit;
}

std::vector<ElementOfScene> elements_of(const Scene& scene) {
  std::vector<ElementOfScene> elements;
  if (!scene.mbd) return elements;
  const Mbd& mbd = *scene.mbd;
  const auto begin = [&](Source source, std::size_t index, std::string kind,
                         std::string name) -> ElementOfScene& {
    return elements.emplace_back(source, index, std::move(kind), std::move(name),
                                 std::vector<ElementColumn>());
  };
  for (std::size_t j = 0; j < mbd.joints.size(); ++j) {
    Columns columns(begin(Source::joint, j, "joint", mbd.joints[j].name));
    add_columns(mbd.joints[j], columns);
    if (elements.back().columns.empty()) elements.pop_back();
  }
  for (std::size_t k = 0; k < mbd.couplers.size(); ++k) {
    const Coupler& coupler = mbd.couplers[k];
    const std::string kind = kind_of(coupler.type);
    const bool taken = has(mbd.joints, coupler.name);
    Columns columns(begin(Source::coupler, k, kind, taken ? kind + ":" + coupler.name : coupler.name));
    add_columns(coupler, mbd, columns);
  }
  for (std::size_t f = 0; f < mbd.forces.size(); ++f) {
    const std::string& name =
        std::visit([](const auto& force) -> const std::string& { return force.name; }, mbd.forces[f]);
    const std::string kind = kind_of(mbd.forces[f]);
    const bool taken = has(mbd.joints, name) || has(mbd.couplers, name);
    Columns columns(begin(Source::force, f, kind, taken ? kind + ":" + name : name));
    add_columns(mbd.forces[f], mbd, columns);
  }
  for (std::size_t i = 0; scene.contact && i < scene.contact->outputs.size(); ++i) {
    Columns columns(begin(Source::contact, i, "contact", scene.contact->outputs[i].name));
    add_contact_columns(columns);
  }
  return elements;
}

std::vector<std::string> element_columns(const Scene& scene) {
  std::vector<std::string> names;
  for (const ElementOfScene& element : elements_of(scene))
    for (const ElementColumn& column : element.columns) names.push_back(column.name);
  return names;
}

std::string element_channels_as_markdown() {
  std::string table = "| channel | unit | meaning |\n|---|---|---|\n";
  for (const ChannelFacts& row : channels)
    table += std::string("| `") + row.name + "` | " + row.unit + " | " + row.meaning + " |\n";
  return table;
}

}  // namespace tandem::scene
