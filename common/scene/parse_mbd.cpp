#include "common/scene/fault.hpp"
#include "common/scene/implicit_settings.hpp"
#include "common/scene/parse_parts.hpp"
#include "common/scene/reserved_names.hpp"

namespace tandem::scene {

namespace {

Body parse_body(const Node& node) {
  Body body;
  node.read("name", body.name);
  body.from_shapes = node.value().at("mass").is_string();
  if (body.from_shapes) {
    if (node.has("inertia"))
      node.fail("inertia", "the inertia is given, and follows from the shapes",
                "leave it out, or give the mass as a number");
    if (!node.has("shapes") || node.value().at("shapes").empty())
      node.fail("mass", "the mass follows from the shapes, and the body has none",
                "add shapes, or give mass and inertia");
  } else {
    if (!node.has("inertia"))
      node.fail("the key 'inertia' is missing",
                "add inertia: about the centre of mass in body axes: xx, yy, zz, or xx, yy, zz, xy, xz, yz "
                "[kg m2]");
    node.read("mass", body.mass);
    const auto inertia = node.value().at("inertia").get<std::vector<double>>();
    std::copy(inertia.begin(), inertia.end(), body.inertia.begin());
  }
  node.read("position", body.pose.p_WB);
  node.read("orientation", body.pose.q_WB);
  node.read("velocity", body.twist.v_WB);
  node.read("angular_velocity", body.twist.w_WB);
  body.colour = read_colour(node);
  node.read("assembly", body.assembly);
  return body;
}

MotionOf parse_of(const Node& node) {
  return node.has("of") && node.value().at("of") == "speed" ? MotionOf::speed : MotionOf::position;
}

// In format 1.0 every table without another setting is a natural spline.
Interpolation parse_interpolation(const Node& node, const std::string& format) {
  if (!node.has("interpolation")) return format == "1.0" ? Interpolation::spline : Interpolation::monotone;
  const auto word = node.value().at("interpolation").get<std::string>();
  return word == "linear"   ? Interpolation::linear
         : word == "step"   ? Interpolation::step
         : word == "spline" ? Interpolation::spline
                            : Interpolation::monotone;
}

}  // namespace

Motion parse_motion(const Node& node, const std::string& format) {
  const std::string type = node.type();
  if (type == "constant") {
    ConstantMotion motion;
    node.read("value", motion.value);
    node.read("rate", motion.rate);
    return motion;
  }
  if (type == "ramp") {
    RampMotion motion;
    node.read("from", motion.from);
    node.read("to", motion.to);
    node.read("start", motion.start);
    node.read("duration", motion.duration);
    motion.of = parse_of(node);
    node.read("offset", motion.offset);
    return motion;
  }
  if (type == "harmonic") {
    HarmonicMotion motion;
    node.read("offset", motion.offset);
    node.read("amplitude", motion.amplitude);
    node.read("frequency", motion.frequency);
    node.read("phase", motion.phase);
    return motion;
  }
  TableMotion motion;
  node.read("times", motion.times);
  node.read("values", motion.values);
  motion.interpolation = parse_interpolation(node, format);
  node.read("smoothing", motion.smoothing);
  motion.of = parse_of(node);
  node.read("offset", motion.offset);
  return motion;
}

Limits parse_limits(const Node& node) {
  Limits limits;
  node.read("lower", limits.lower);
  node.read("upper", limits.upper);
  node.read("stiffness", limits.stiffness);
  node.read("damping", limits.damping);
  if (node.has("restitution")) {
    if (node.has("damping"))
      node.fail("restitution", "the damping is given as well, and each follows from the other",
                "leave out one of the two");
    node.read("restitution", limits.restitution.emplace());
  }
  return limits;
}

Friction parse_friction(const Node& node) {
  Friction friction;
  node.read("force", friction.force);
  node.read("slip", friction.slip);
  node.read("breakaway", friction.breakaway);
  if (node.has("slip") == node.has("breakaway"))
    node.fail(std::string("there is ") +
                  (node.has("slip") ? "a slip and a breakaway" : "neither slip nor breakaway"),
              "give one of them: with slip the joint creeps under a load, with breakaway it stays at rest");
  return friction;
}

namespace {

JointType joint_type(const std::string& type) {
  if (type == "fixed") return JointType::fixed;
  if (type == "revolute") return JointType::revolute;
  if (type == "prismatic") return JointType::prismatic;
  if (type == "spherical") return JointType::spherical;
  if (type == "cylindrical") return JointType::cylindrical;
  if (type == "universal") return JointType::universal;
  if (type == "planar") return JointType::planar;
  if (type == "screw") return JointType::screw;
  if (type == "distance") return JointType::distance;
  return JointType::free;
}

Joint parse_joint(const Node& node, const Names& bodies, const std::string& format) {
  Joint joint;
  node.read("name", joint.name);
  joint.type = joint_type(node.type());
  joint.parent = read_body(node, "parent", bodies);
  if (node.value().at("child") == "ground")
    node.fail("child", "the ground is no child of a joint", "swap parent and child");
  joint.child = BodyId{node.resolve("child", bodies, "bodies")};
  node.read("position", joint.position);
  if (node.has("child_position")) node.read("child_position", joint.child_position.emplace());
  node.read_unit("axis", joint.axis);
  node.read_unit("axis2", joint.axis2);
  node.read("pitch", joint.pitch);
  node.read("length", joint.length);
  node.read("rate", joint.rate);
  node.read("damping", joint.damping);
  node.read("cut", joint.cut);
  if (node.has("limits")) joint.limits = parse_limits(node.at("limits"));
  if (node.has("friction")) joint.friction = parse_friction(node.at("friction"));
  if (node.has("motion")) joint.motion = parse_motion(node.at("motion"), format);
  return joint;
}

// A coordinate of a joint; `factor` is read where it is there.
CoupledJoint parse_coupled(const Node& node, const char* joint_key, const char* coordinate_key,
                           const Names& joints, const std::vector<Joint>& list) {
  CoupledJoint coupled;
  coupled.joint = JointId{node.resolve(joint_key, joints, "joints")};
  node.read("factor", coupled.factor);
  const Joint& joint = list[coupled.joint.value];
  const bool cylindrical = joint.type == JointType::cylindrical;
  if (node.has(coordinate_key) != cylindrical)
    node.fail(cylindrical ? joint_key : coordinate_key,
              "joint '" + joint.name + "' " +
                  (cylindrical ? "is cylindrical, with two coordinates" : "has one coordinate"),
              cylindrical ? std::string("add \"") + coordinate_key + "\": \"angle\" or \"displacement\""
                          : std::string("leave it out"));
  if (cylindrical && node.value().at(coordinate_key) == "displacement")
    coupled.coordinate = JointCoordinate::displacement;
  return coupled;
}

Coupler parse_coupler(const Node& node, const Names& joints, const std::vector<Joint>& list) {
  Coupler coupler;
  node.read("name", coupler.name);
  const std::string type = node.type();
  if (type == "linear") {
    coupler.type = CouplerType::linear;
    for (const Node& term : node.elements("terms"))
      coupler.terms.push_back(parse_coupled(term, "joint", "coordinate", joints, list));
    return coupler;
  }
  if (type == "cam") {
    coupler.type = CouplerType::cam;
    coupler.terms = {parse_coupled(node, "joint_a", "coordinate_a", joints, list),
                     parse_coupled(node, "joint_b", "coordinate_b", joints, list)};
    const Node table = node.at("table");
    coupler.table.emplace();
    table.read("arguments", coupler.table->arguments);
    table.read("values", coupler.table->values);
    table.read("period", coupler.table->period);
    return coupler;
  }
  coupler.type = type == "gear"   ? CouplerType::gear
                 : type == "belt" ? CouplerType::belt
                                  : CouplerType::rack_and_pinion;
  coupler.joint_a = JointId{node.resolve("joint_a", joints, "joints")};
  coupler.joint_b = JointId{node.resolve("joint_b", joints, "joints")};
  node.read("ratio", coupler.ratio);
  return coupler;
}

}  // namespace

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
  node.read("radius", tyre.radius);
  node.read("stiffness", tyre.stiffness);
  node.read("damping", tyre.damping);
  node.read("friction", tyre.friction);
  node.read("slip_stiffness", tyre.slip_stiffness);
  node.read("cornering_stiffness", tyre.cornering_stiffness);
  node.read("relaxation_length", tyre.relaxation_length);
  node.read("lateral_relaxation_length", tyre.lateral_relaxation_length);
  node.read("rolling_resistance", tyre.rolling_resistance);
  node.read("patch_length", tyre.patch_length);
  if (node.has("road")) {
    for (const auto& name : node.value().at("road")) tyre.road.push_back(name.get<std::string>());
    if (node.has("road_point"))
      node.fail("road_point", "the road is that of the shapes in 'road', not a plane through a point",
                "leave out road_point or road");
    if (!(tyre.patch_length > 0))
      node.fail("patch_length", "a tyre on shapes of the ground needs the length of its patch, and it is 0",
                "give patch_length: the road under the tyre is the plane through points of its patch");
  }
  node.read("road_point", tyre.road_point);
  node.read("road_normal", tyre.road_normal);
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

}  // namespace

BodyId read_body(const Node& node, const char* key, const Names& bodies) {
  if (!node.has(key) || node.value().at(key) == "ground") return ground;
  return BodyId{node.resolve(key, bodies, "bodies")};
}

// The explicit method has an error control always, and none of the numbers of the implicit method.
Integrator parse_integrator(const Node& node) {
  constexpr double usual_tolerance = 1e-6;
  Integrator integrator;
  if (node.has("method") && node.value().at("method") == "dormand_prince")
    integrator.method = IntegrationMethod::dormand_prince;
  node.read("rho_inf", integrator.rho_inf);
  node.read("step", integrator.step);
  if (node.has("formulation") && node.value().at("formulation") == "index3")
    integrator.formulation = Formulation::index3;
  node.read("extrapolate", integrator.extrapolate);
  node.read("error_tolerance", integrator.error_tolerance);
  node.read("min_step", integrator.min_step);
  node.read("assembly_tolerance", integrator.assembly_tolerance);
  node.read("tolerance", integrator.tolerance);
  node.read("max_iterations", integrator.max_iterations);
  if (integrator.method == IntegrationMethod::dormand_prince) {
    for (const char* key : implicit_settings)
      if (node.has(key))
        node.fail(key, "the method 'dormand_prince' has no such setting",
                  "leave it out, or write \"method\": \"generalized_alpha\"");
    if (!integrator.error_tolerance) integrator.error_tolerance = usual_tolerance;
  }
  return integrator;
}

Mbd parse_mbd(const Node& node, const std::string& format) {
  const std::vector<std::string>& reserved = reserved_body_names();
  Mbd mbd;
  read_server(node, mbd);
  if (node.has("integrator")) mbd.integrator = parse_integrator(node.at("integrator"));
  if (node.has("start") && node.value().at("start") == "equilibrium") mbd.start = Start::equilibrium;
  for (const Node& body : node.elements("bodies")) mbd.bodies.push_back(parse_body(body));
  const auto bodies = node.names("bodies", reserved);
  for (const Node& joint : node.elements("joints")) mbd.joints.push_back(parse_joint(joint, bodies, format));
  const auto joints = node.names("joints", reserved);
  node.names("couplers");
  for (const Node& coupler : node.elements("couplers"))
    mbd.couplers.push_back(parse_coupler(coupler, joints, mbd.joints));
  node.names("forces");
  for (const Node& force : node.elements("forces"))
    mbd.forces.push_back(parse_force(force, bodies, joints, format));
  node.read("sensors", mbd.sensors);
  return mbd;
}

}  // namespace tandem::scene
