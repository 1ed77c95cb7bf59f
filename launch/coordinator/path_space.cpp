#include "launch/coordinator/path_space.hpp"

#include <cmath>

namespace tandem::launch {
namespace {

using protocol::BodyMotion;
using protocol::MotionSet;

void put(Eigen::VectorXd& point, Eigen::Index at, double factor, Vec3d v) {
  point.segment<3>(at) << factor * v.x, factor * v.y, factor * v.z;
}

Vec3d take(const Eigen::VectorXd& point, Eigen::Index at) {
  return {point[at], point[at + 1], point[at + 2]};
}

}  // namespace

PathSpace::PathSpace(const scene::Scene& scene) {
  if (!scene.mbd) return;
  for (const scene::Body& body : scene.mbd->bodies)
    gyration_.push_back(std::sqrt((body.inertia[0] + body.inertia[1] + body.inertia[2]) / (2 * body.mass)));
}

Eigen::VectorXd PathSpace::difference(const MotionSet& to, const MotionSet& from) const {
  const double H = from.window.length();
  Eigen::VectorXd point(static_cast<Eigen::Index>(12 * from.bodies.size()));
  for (std::size_t b = 0; b < from.bodies.size(); ++b) {
    const BodyMotion &one = to.bodies[b], &other = from.bodies[b];
    const double L = gyration(other.body);
    const auto at = static_cast<Eigen::Index>(12 * b);
    put(point, at, 1, one.end_pose.p_WB - other.end_pose.p_WB);
    put(point, at + 3, L, rotation_vector(one.end_pose.q_WB * other.end_pose.q_WB.conjugate()));
    put(point, at + 6, H, one.end_twist.v_WB - other.end_twist.v_WB);
    put(point, at + 9, H * L, one.end_twist.w_WB - other.end_twist.w_WB);
  }
  return point;
}

MotionSet PathSpace::moved(const MotionSet& from, const Eigen::VectorXd& point) const {
  MotionSet path = from;
  const double H = from.window.length();
  for (std::size_t b = 0; b < path.bodies.size(); ++b) {
    const auto at = static_cast<Eigen::Index>(12 * b);
    if (point.segment<12>(at).isZero(0)) continue;
    BodyMotion& body = path.bodies[b];
    const double L = gyration(body.body);
    body.end_pose.p_WB += take(point, at);
    const Vec3d turn = (1 / L) * take(point, at + 3);
    if (turn != Vec3d{}) body.end_pose.q_WB = (exp(turn) * body.end_pose.q_WB).normalized();
    body.end_twist.v_WB += (1 / H) * take(point, at + 6);
    body.end_twist.w_WB += (1 / (H * L)) * take(point, at + 9);
  }
  return path;
}

double PathSpace::motion(const MotionSet& path) const {
  const double H = path.window.length();
  double sum = 0;
  for (const BodyMotion& body : path.bodies) {
    const double L = gyration(body.body);
    const double turn = L * norm(rotation_vector(body.end_pose.q_WB * body.begin_pose.q_WB.conjugate()));
    sum += norm2(body.end_pose.p_WB - body.begin_pose.p_WB) + turn * turn + norm2(H * body.end_twist.v_WB) +
           norm2((H * L) * body.end_twist.w_WB);
  }
  return std::sqrt(sum);
}

}  // namespace tandem::launch
