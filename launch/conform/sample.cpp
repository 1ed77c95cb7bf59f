#include "launch/conform/sample.hpp"

#include <algorithm>
#include <cstring>
#include <set>

#include "common/error.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;

// Records have no gaps (protocol/layout.hpp).
template <class Record>
bool same(const std::vector<Record>& a, const std::vector<Record>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Record)) == 0);
}
template <class Record>
bool same(const Record& a, const Record& b) {
  return std::memcmp(&a, &b, sizeof(Record)) == 0;
}

}  // namespace

std::vector<BodyLoad> sample_loads(const scene::Scene& scene, const std::vector<BodyMotion>& boundary,
                                   double share) {
  std::vector<BodyLoad> loads;
  for (const BodyMotion& motion : boundary) {
    const scene::Body& body = scene.mbd.value().bodies.at(motion.body);
    const double side = motion.body % 4 == 2 ? -1 : 1,
                 inertia = (body.inertia[0] + body.inertia[1] + body.inertia[2]) / 3;
    BodyLoad load;
    load.body = motion.body;
    load.mean.force = (share * side * body.mass) * Vec3d{1.5, -0.9, 2.4};
    load.mean.torque = (share * side * inertia) * Vec3d{2, -1, 1.5};
    load.end = load.mean;
    loads.push_back(load);
  }
  return loads;
}

std::vector<std::uint32_t> boundary_bodies(const scene::Scene& scene) {
  std::set<std::uint32_t> bodies;
  for (const scene::Wall& wall : scene.walls())
    if (wall.body != ground) bodies.insert(wall.body.value);
  return {bodies.begin(), bodies.end()};
}

Pose moved(const Pose& begin, const Twist& twist, double time) {
  return {begin.p_WB + time * twist.v_WB, (exp(time * twist.w_WB) * begin.q_WB).normalized()};
}

BodyMotion steady_path(std::uint32_t body, const Pose& begin, const Twist& twist, double length) {
  BodyMotion motion;
  motion.body = body;
  motion.begin_pose = begin;
  motion.end_pose = moved(begin, twist, length);
  motion.begin_twist = motion.end_twist = twist;
  return motion;
}

std::vector<BodyMotion> paths_at_rest(const scene::Scene& scene) {
  std::vector<BodyMotion> paths;
  for (const std::uint32_t body : boundary_bodies(scene))
    paths.push_back(steady_path(body, scene.mbd.value().bodies.at(body).pose, {}, 0));
  return paths;
}

const BodyLoad* load_on(const std::vector<BodyLoad>& loads, std::uint32_t body) {
  const auto found = std::ranges::find(loads, body, &BodyLoad::body);
  return found == loads.end() ? nullptr : &*found;
}

const BodyMotion& motion_of(const protocol::MotionSet& motion, std::uint32_t body) {
  const auto found = std::ranges::find(motion.bodies, body, &BodyMotion::body);
  if (found == motion.bodies.end())
    throw Error(ErrorCode::protocol, "body " + std::to_string(body) + " has a wall, but no motion",
                "mbd_server", "send the motion of each body with a wall");
  return *found;
}

bool same_bits(const protocol::MotionSet& a, const protocol::MotionSet& b) {
  return same(a.bodies, b.bodies);
}

bool same_bits(const protocol::LoadSet& a, const protocol::LoadSet& b) {
  protocol::ParticleAccount first = a.account, second = b.account;
  first.rebuilds = second.rebuilds = 0;
  return same(first, second) && same(a.bodies, b.bodies);
}

bool same_bits(const protocol::BodiesFrame& a, const protocol::BodiesFrame& b) {
  return same(a.bodies, b.bodies) && same(a.joints, b.joints) && same(a.energy, b.energy) &&
         same(a.elements, b.elements);
}

bool same_bits(const protocol::ParticlesFrame& a, const protocol::ParticlesFrame& b) {
  return same(a.id, b.id) && same(a.position, b.position) && same(a.velocity, b.velocity) &&
         same(a.spin, b.spin) && same(a.radius, b.radius) && same(a.liquid, b.liquid);
}

}  // namespace tandem::conform
