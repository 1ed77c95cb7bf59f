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
  read_keys(node, integrator);
  if (node.has("formulation") && node.value().at("formulation") == "index3")
    integrator.formulation = Formulation::index3;
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
