#include "tests/verification/mbd/recorded_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "common/log.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"

namespace tandem::mbd {
namespace {

double kinetic_energy(const scene::Body& body, const protocol::BodyState& seen) {
  const Vec3d w = seen.pose.q_WB.conjugate().rotate(seen.twist.w_WB);
  const auto& I = body.inertia;
  const Vec3d spin{I[0] * w.x + I[3] * w.y + I[4] * w.z, I[3] * w.x + I[1] * w.y + I[5] * w.z,
                   I[4] * w.x + I[5] * w.y + I[2] * w.z};
  return .5 * body.mass * dot(seen.twist.v_WB, seen.twist.v_WB) + .5 * dot(w, spin);
}

// All that the joints on the ground give to the machine; the torque about the scene's point `about`.
Wrench from_ground(const scene::Scene& scene, const std::vector<protocol::BodyState>& bodies,
                   const std::vector<Wrench>& reactions, Vec3d about) {
  Wrench sum;
  for (std::size_t j = 0; j < scene.mbd->joints.size(); ++j) {
    const scene::Joint& joint = scene.mbd->joints[j];
    if (joint.parent != ground) continue;
    // The joint point moves with the child.
    const Pose& start = scene.mbd->bodies[joint.child.value].pose;
    const Pose& now = bodies[joint.child.value].pose;
    const Vec3d arm =
        start.q_WB.conjugate().rotate(joint.child_position.value_or(joint.position) - start.p_WB);
    const Vec3d point = now.p_WB + now.q_WB.rotate(arm);
    sum.force += reactions[j].force;
    sum.torque += reactions[j].torque + cross(point - about, reactions[j].force);
  }
  return sum;
}

double ratio(double deviation, double scale) {
  return scale > 0 ? deviation / scale : deviation;
}

}  // namespace

RecordedRun record(const scene::Scene& scene, double end, int windows) {
  log::setup("test", "error");
  RecordedRun run;
  MbdSolver solver;
  scene::Scene copy = scene;
  copy.coupling.window = end / windows;
  const auto facts = nlohmann::json::parse(solver.configure(copy).facts);
  run.degrees_of_freedom = facts.at("dof");
  run.redundant = facts.at("mbd_redundant_equations").size();
  run.frames.push_back(solver.observe());
  protocol::LoadSet loads;
  for (int n = 0; n < windows; ++n) {
    loads.window = {static_cast<std::uint64_t>(n), to_nanoseconds(n * end / windows),
                    to_nanoseconds((n + 1) * end / windows)};
    solver.advance(loads);
    run.frames.push_back(solver.observe());
  }
  for (const protocol::BodiesFrame& frame : run.frames) {
    double kinetic = 0;
    for (const protocol::BodyState& body : frame.bodies)
      kinetic += kinetic_energy(scene.mbd->bodies[body.body], body);
    run.energy_scale =
        std::max({run.energy_scale, kinetic, std::abs(frame.energy - run.frames.front().energy)});
  }
  for (const auto& warning : nlohmann::json::parse(solver.report().facts).at("warnings"))
    run.warnings.push_back(warning.is_string() ? warning.get<std::string>() : warning.dump());
  return run;
}

RecordedRun in_units_of(const scene::Scene& scene, RecordedRun run, double length, double mass) {
  const double force = mass * length, torque = force * length;
  run.energy_scale /= torque;
  for (protocol::BodiesFrame& frame : run.frames) {
    frame.energy /= torque;
    for (protocol::BodyState& body : frame.bodies)
      body.pose.p_WB *= 1 / length, body.twist.v_WB *= 1 / length;
    for (std::size_t j = 0; j < frame.joints.size(); ++j) {
      protocol::JointState& joint = frame.joints[j];
      joint.reaction.force *= 1 / force, joint.reaction.torque *= 1 / torque;
      if (scene.mbd->joints[j].type == scene::JointType::prismatic) joint.q /= length, joint.rate /= length;
    }
  }
  return run;
}

scene::Scene heavier(const scene::Scene& given, double share, std::mt19937_64& random) {
  scene::Scene scene = given;
  std::uniform_real_distribution<double> change(-share, share);
  for (scene::Body& body : scene.mbd->bodies) {
    body.mass *= 1 + change(random);
    for (std::size_t i = 0; i < 3; ++i) body.inertia[i] *= 1 + change(random);
  }
  return scene;
}

double size_of(const scene::Scene& scene) {
  std::vector<Vec3d> points;
  for (const scene::Body& body : scene.mbd->bodies) points.push_back(body.pose.p_WB);
  for (const scene::Joint& joint : scene.mbd->joints) points.push_back(joint.position);
  double size = 0;
  for (const Vec3d& a : points)
    for (const Vec3d& b : points) size = std::max(size, norm(a - b));
  return size > 0 ? size : 1;
}

double Deviation::most() const {
  if (std::isnan(pose + velocity + energy)) return std::numeric_limits<double>::quiet_NaN();
  return std::max({pose, velocity, energy});
}

Deviation deviation(const scene::Scene& scene, const RecordedRun& first, const RecordedRun& second,
                    const test::RigidMotion& motion, const Indices& indices, std::size_t frames) {
  const double size = size_of(scene);
  Deviation d;
  double speed = 0, force = 0;  // largest of the first run
  double off_speed = 0, off_force = 0, off_ground = 0;
  const auto add = [](double& largest, double value) {
    // A value that is no number is the largest.
    if (!std::isnan(largest) && !(value <= largest)) largest = value;
  };
  const Vec3d middle = scene.mbd->bodies.front().pose.p_WB;
  for (std::size_t n = 0; n < frames; ++n) {
    const protocol::BodiesFrame &a = first.frames.at(n), &b = second.frames.at(n);
    std::vector<protocol::BodyState> bodies;
    std::vector<Wrench> reactions_a, reactions_b;
    for (std::size_t k = 0; k < a.bodies.size(); ++k) {
      const protocol::BodyState& seen = a.bodies[k];
      protocol::BodyState there = b.bodies.at(indices.body[k]);
      there.pose = {motion.point_back(there.pose.p_WB), motion.q.conjugate() * there.pose.q_WB};
      there.twist = {motion.vector_back(there.twist.v_WB), motion.vector_back(there.twist.w_WB)};
      add(speed, norm(seen.twist.v_WB)), add(speed, size * norm(seen.twist.w_WB));
      add(d.pose, norm(seen.pose.p_WB - there.pose.p_WB) / size);
      add(d.pose, norm(rotation_vector(seen.pose.q_WB.conjugate() * there.pose.q_WB)));
      add(off_speed, norm(seen.twist.v_WB - there.twist.v_WB));
      add(off_speed, size * norm(seen.twist.w_WB - there.twist.w_WB));
      bodies.push_back(there);
    }
    for (std::size_t j = 0; j < a.joints.size(); ++j) {
      const protocol::JointState &seen = a.joints[j], &there = b.joints.at(indices.joint[j]);
      const bool slides = scene.mbd->joints[j].type == scene::JointType::prismatic;
      add(off_speed, (slides ? 1 : size) * std::abs(seen.rate - there.rate));
      const Wrench back{motion.vector_back(there.reaction.force), motion.vector_back(there.reaction.torque)};
      add(force, norm(seen.reaction.force)), add(force, norm(seen.reaction.torque) / size);
      add(off_force, norm(seen.reaction.force - back.force));
      add(off_force, norm(seen.reaction.torque - back.torque) / size);
      reactions_a.push_back(seen.reaction), reactions_b.push_back(back);
    }
    const Wrench ground_a = from_ground(scene, a.bodies, reactions_a, middle),
                 ground_b = from_ground(scene, bodies, reactions_b, middle);
    add(off_ground, norm(ground_a.force - ground_b.force));
    add(off_ground, norm(ground_a.torque - ground_b.torque) / size);
    const double energy_a = a.energy - first.frames.front().energy,
                 energy_b = b.energy - second.frames.front().energy;
    add(d.energy, ratio(std::abs(energy_a - energy_b), first.energy_scale));
  }
  d.velocity = ratio(off_speed, speed);
  d.reaction = ratio(off_force, force);
  d.on_ground = ratio(off_ground, force);
  return d;
}

Deviation deviation(const scene::Scene& scene, const RecordedRun& first, const RecordedRun& second,
                    const test::RigidMotion& motion) {
  Indices same;
  same.body.resize(scene.mbd->bodies.size()), same.joint.resize(scene.mbd->joints.size());
  std::iota(same.body.begin(), same.body.end(), 0u);
  std::iota(same.joint.begin(), same.joint.end(), 0u);
  return deviation(scene, first, second, motion, same, std::min(first.frames.size(), second.frames.size()));
}

}  // namespace tandem::mbd
