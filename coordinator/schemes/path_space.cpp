#include "coordinator/schemes/path_space.hpp"

#include <cmath>
#include <utility>

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

PathSpace::PathSpace(const scene::Scene& scene, Departure departure) : departure_(departure) {
  if (!scene.mbd) return;
  for (const scene::Body& body : scene.mbd->bodies)
    gyration_.push_back(std::sqrt((body.inertia[0] + body.inertia[1] + body.inertia[2]) / (2 * body.mass)));
}

Eigen::VectorXd PathSpace::difference(const MotionSet& to, const MotionSet& from) const {
  const double H = from.window.length();
  Eigen::VectorXd point(lengths() * static_cast<Eigen::Index>(from.bodies.size()));
  Eigen::Index at = 0;
  for (std::size_t b = 0; b < from.bodies.size(); ++b, at += lengths()) {
    const BodyMotion &one = to.bodies[b], &other = from.bodies[b];
    const double L = gyration(other.body);
    put(point, at, 1, one.end_pose.p_WB - other.end_pose.p_WB);
    put(point, at + 3, L, rotation_vector(one.end_pose.q_WB * other.end_pose.q_WB.conjugate()));
    if (departure_ == Departure::straight) continue;
    put(point, at + 6, H, one.end_twist.v_WB - other.end_twist.v_WB);
    put(point, at + 9, H * L, one.end_twist.w_WB - other.end_twist.w_WB);
  }
  return point;
}

MotionSet PathSpace::moved(const MotionSet& from, const Eigen::VectorXd& point) const {
  MotionSet path = from;
  const double H = from.window.length();
  Eigen::Index at = 0;
  for (BodyMotion& body : path.bodies) {
    const Eigen::Index own = std::exchange(at, at + lengths());
    if (point.segment(own, lengths()).isZero(0)) continue;
    const double L = gyration(body.body);
    const Vec3d move = take(point, own), turn = (1 / L) * take(point, own + 3);
    body.end_pose.p_WB += move;
    if (turn != Vec3d{}) body.end_pose.q_WB = (exp(turn) * body.end_pose.q_WB).normalized();
    if (departure_ == Departure::straight) {
      for (Twist* twist : {&body.begin_twist, &body.end_twist}) {
        twist->v_WB += (1 / H) * move;
        twist->w_WB += (1 / H) * turn;
      }
    } else {
      body.end_twist.v_WB += (1 / H) * take(point, own + 6);
      body.end_twist.w_WB += (1 / (H * L)) * take(point, own + 9);
    }
  }
  return path;
}

double PathSpace::motion(const MotionSet& path) const {
  const double H = path.window.length();
  double sum = 0;
  for (const BodyMotion& body : path.bodies) {
    const double L = gyration(body.body);
    const double turn = L * norm(rotation_vector(body.end_pose.q_WB * body.begin_pose.q_WB.conjugate()));
    sum += norm2(body.end_pose.p_WB - body.begin_pose.p_WB) + turn * turn;
    if (departure_ == Departure::straight) continue;
    sum += norm2(H * body.end_twist.v_WB) + norm2((H * L) * body.end_twist.w_WB);
  }
  return std::sqrt(sum);
}

}  // namespace tandem::launch
