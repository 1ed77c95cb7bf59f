#include "common/scene/fault.hpp"
#include "common/scene/parse_parts.hpp"
#include "common/scene/reserved_names.hpp"

namespace tandem::scene {

std::optional<ForceTable> parse_table(const Node& node, const char* key) {
  if (!node.has(key)) return {};
  ForceTable table;
  node.at(key).read("arguments", table.arguments);
  node.at(key).read("values", table.values);
  return table;
}

namespace {

// Six numbers are the diagonal.
void read_matrix(const Node& node, const char* key, std::array<double, 36>& matrix) {
  if (!node.has(key)) return;
  const auto values = node.value().at(key).get<std::vector<double>>();
  if (values.size() == matrix.size()) {
    std::copy(values.begin(), values.end(), matrix.begin());
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) matrix[7 * i] = values[i];
}

Force parse_bushing(const Node& node, const Names& bodies) {
  Bushing bushing;
  node.read("name", bushing.name);
  bushing.body_a = read_body(node, "body_a", bodies);
  bushing.body_b = read_body(node, "body_b", bodies);
  node.read("position", bushing.position);
  read_matrix(node, "stiffness", bushing.stiffness);
  read_matrix(node, "damping", bushing.damping);
  return bushing;
}

std::optional<JointFunction> parse_over(const Node& node, const Names& joints) {
  if (!node.has("over")) return {};
  const Node over = node.at("over");
  JointFunction function;
  function.joint = JointId{over.resolve("joint", joints, "joints")};
  function.of_rate = over.has("of") && over.value().at("of") == "rate";
  over.read("arguments", function.table.arguments);
  over.read("values", function.table.values);
  over.read("period", function.period);
  if (function.of_rate && function.period)
    over.fail("period", "a rate has no period", "leave it out, or give a function of the coordinate");
  return function;
}

Force parse_load(const Node& node, const Names& bodies, const Names& joints, const std::string& format) {
  BodyLoad load;
  node.read("name", load.name);
  load.kind = node.type() == "force" ? BodyLoad::Kind::force : BodyLoad::Kind::torque;
  load.body = BodyId{node.resolve("body", bodies, "bodies")};
  node.read("point", load.point);
  node.read_unit("direction", load.direction);
  node.read("follows", load.follows);
  if (node.has("size") == node.has("over"))
    node.fail(
        "the " + node.type() + " has " + (node.has("size") ? "a size and an over" : "neither size nor over"),
        "give one of them: a function of time, or of a joint coordinate");
  if (node.has("size")) load.size = parse_motion(node.at("size"), format);
  load.over = parse_over(node, joints);
  return load;
}

Force parse_actuator(const Node& node, const Names& joints, const std::string& format) {
  Actuator actuator;
  node.read("name", actuator.name);
  actuator.joint = JointId{node.resolve("joint", joints, "joints")};
  if (node.has("size") + node.has("input") + node.has("over") != 1)
    node.fail(
        node.has("size") && node.has("input") ? "the actuator has a size and an input"
        : node.has("over")                    ? "the actuator has an over, and a size or an input as well"
                                              : "the actuator has neither size nor input",
        "give one of them: a function of time, or the name of a control input, or over, a function of a "
        "joint coordinate");
  node.read("input", actuator.input);
  if (node.has("size")) actuator.size = parse_motion(node.at("size"), format);
  actuator.over = parse_over(node, joints);
  return actuator;
}

Force parse_rope(const Node& node, const Names& bodies, const Names& joints) {
  Rope rope;
  node.read("name", rope.name);
  for (const Node& point : node.elements("points")) {
    RopePoint& to = rope.points.emplace_back();
    to.body = read_body(point, "body", bodies);
    point.read("point", to.point);
  }
  node.read("length", rope.length);
  node.read("axial_stiffness", rope.axial_stiffness);
  node.read("damping", rope.damping);
  if (node.has("drum")) rope.drum = JointId{node.resolve("drum", joints, "joints")};
  return rope;
}

Force parse_tyre(const Node& node, const Names& joints) {
  Tyre tyre;
  node.read("name", tyre.name);
  tyre.joint = JointId{node.resolve("joint", joints, "joints")};
  read_keys(node, tyre);
  if (node.has("road")) {
    for (const auto& name : node.value().at("road")) tyre.road.push_back(name.get<std::string>());
    if (node.has("road_point"))
      node.fail("road_point", "the road is that of the shapes in 'road', not a plane through a point",
                "leave out road_point or road");
    if (!(tyre.patch_length > 0))
      node.fail("patch_length", "a tyre on shapes of the ground needs the length of its patch, and it is 0",
                "give patch_length: the road under the tyre is the plane through points of its patch");
  }
  return tyre;
}

// A type that reads itself, from the I-th of all types on.
template <std::size_t I = 0>
std::optional<Force> parse_own(const Node& node, const Names& bodies, const Names& joints) {
  if constexpr (I < std::variant_size_v<Force>) {
    using Type = std::variant_alternative_t<I, Force>;
    if constexpr (requires { Type::read(node, bodies, joints); })
      if (node.type() == Type::type) return Type::read(node, bodies, joints);
    return parse_own<I + 1>(node, bodies, joints);
  }
  return {};
}

}  // namespace

Force parse_force(const Node& node, const Names& bodies, const Names& joints, const std::string& format) {
  if (std::optional<Force> force = parse_own(node, bodies, joints)) return *force;
  if (node.type() == "bushing") return parse_bushing(node, bodies);
  if (node.type() == "force" || node.type() == "torque") return parse_load(node, bodies, joints, format);
  if (node.type() == "actuator") return parse_actuator(node, joints, format);
  if (node.type() == "rope") return parse_rope(node, bodies, joints);
  if (node.type() == "tyre") return parse_tyre(node, joints);
  if (node.type() == "motor") return parse_motor(node, joints, format);
  if (node.type() == "cylinder") return parse_cylinder(node, bodies, format);
  if (node.type() == "spring_damper") {
    SpringDamper spring;
    node.read("name", spring.name);
    spring.body_a = read_body(node, "body_a", bodies);
    spring.body_b = read_body(node, "body_b", bodies);
    node.read("point_a", spring.point_a);
    node.read("point_b", spring.point_b);
    node.read("stiffness", spring.stiffness);
    node.read("damping", spring.damping);
    node.read("length", spring.length);
    spring.table = parse_table(node, "table");
    spring.damping_table = parse_table(node, "damping_table");
    return spring;
  }
  RotationalSpringDamper spring;
  node.read("name", spring.name);
  spring.joint = JointId{node.resolve("joint", joints, "joints")};
  node.read("stiffness", spring.stiffness);
  node.read("damping", spring.damping);
  node.read("angle", spring.angle);
  spring.table = parse_table(node, "table");
  spring.damping_table = parse_table(node, "damping_table");
  return spring;
}

}  // namespace tandem::scene
