#include "common/scene/fault.hpp"
#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

Body parse_body(const Node& node) {
  Body body;
  node.read("name", body.name);
  node.read("mass", body.mass);
  const auto inertia = node.value().at("inertia").get<std::vector<double>>();
  std::copy(inertia.begin(), inertia.end(), body.inertia.begin());
  node.read("position", body.pose.p_WB);
  node.read("orientation", body.pose.q_WB);
  node.read("velocity", body.twist.v_WB);
  node.read("angular_velocity", body.twist.w_WB);
  return body;
}

Motion parse_motion(const Node& node) {
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
  return motion;
}

JointType joint_type(const std::string& type) {
  if (type == "fixed") return JointType::fixed;
  if (type == "revolute") return JointType::revolute;
  if (type == "prismatic") return JointType::prismatic;
  if (type == "spherical") return JointType::spherical;
  return JointType::free;
}

Joint parse_joint(const Node& node, const std::vector<std::string>& bodies) {
  Joint joint;
  node.read("name", joint.name);
  joint.type = joint_type(node.type());
  joint.parent = read_body(node, "parent", bodies);
  if (node.value().at("child") == "ground")
    node.fail("child", "the ground is no child of a joint", "swap parent and child");
  joint.child = BodyId{node.resolve("child", bodies, "bodies")};
  node.read("position", joint.position);
  node.read_unit("axis", joint.axis);
  node.read("rate", joint.rate);
  node.read("damping", joint.damping);
  if (node.has("motion")) joint.motion = parse_motion(node.at("motion"));
  return joint;
}

Force parse_force(const Node& node, const std::vector<std::string>& bodies,
                  const std::vector<std::string>& joints) {
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
    return spring;
  }
  RotationalSpringDamper spring;
  node.read("name", spring.name);
  spring.joint = JointId{node.resolve("joint", joints, "joints")};
  node.read("stiffness", spring.stiffness);
  node.read("damping", spring.damping);
  node.read("angle", spring.angle);
  return spring;
}

}  // namespace

BodyId read_body(const Node& node, const char* key, const std::vector<std::string>& bodies) {
  if (!node.has(key) || node.value().at(key) == "ground") return ground;
  return BodyId{node.resolve(key, bodies, "bodies")};
}

Mbd parse_mbd(const Node& node) {
  // First parts of `of` in checks that are no names of bodies or joints, and the first column of the results.
  const std::vector<std::string> reserved{"ground", "summary", "time"};

  Mbd mbd;
  if (node.has("integrator")) {
    const Node integrator = node.at("integrator");
    integrator.read("rho_inf", mbd.integrator.rho_inf);
    integrator.read("step", mbd.integrator.step);
    integrator.read("tolerance", mbd.integrator.tolerance);
    integrator.read("max_iterations", mbd.integrator.max_iterations);
  }
  for (const Node& body : node.elements("bodies")) mbd.bodies.push_back(parse_body(body));
  const auto bodies = node.names("bodies", reserved);
  for (const Node& joint : node.elements("joints")) mbd.joints.push_back(parse_joint(joint, bodies));
  const auto joints = node.names("joints", reserved);
  node.names("forces");
  for (const Node& force : node.elements("forces")) mbd.forces.push_back(parse_force(force, bodies, joints));
  return mbd;
}

}  // namespace tandem::scene
