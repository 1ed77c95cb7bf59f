#include "coordinator/watch/path_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coordinator/watch/rigid_body.hpp"

namespace tandem::launch {
namespace {

// Movements below this share of the size of a body and of its distance from the origin, and below this
// angle, are not compared with their integral: states in single precision have errors of a thousandth of it.
constexpr double resolved = 1e-4;
// Sums begin anew where the allowed error has grown to this share of the way: in a long vibration the error
// that a method of first order may have grows, and the way does not.
constexpr double restart_share = 0.1;

// The rotation vector between two orientations, with as many full turns as the velocities make.
Vec3d rotation_between(const Quat& from, const Quat& to, Vec3d by_velocity) {
  const Vec3d rotation = rotation_vector(to * from.conjugate());
  const double angle = norm(rotation);
  if (!(angle > 0)) return rotation;
  constexpr double turn = 2 * std::numbers::pi;
  const double turns = std::round((dot(rotation, by_velocity) / angle - angle) / turn);
  return turns == 0 ? rotation : (1 + turn * turns / angle) * rotation;
}

// The trapezoid rule is wrong by at most half a window times the change of the velocity, where the velocity
// is monotone; so is a method of first order. Twice that is allowed, and the way of one window in addition:
// a body may rebound inside a window.
void add(PathWatch::Sums& sums, Vec3d movement, Vec3d begin, Vec3d end, double H, double floor, double time) {
  const Vec3d integral = (0.5 * H) * (begin + end);
  sums.open += movement - integral;
  sums.integral += integral;
  sums.allowed += H * norm(end - begin);
  sums.way = std::max({sums.way, norm(sums.integral), norm(sums.integral + sums.open)});
  const double open = norm(sums.open), beyond = open - sums.allowed - H * std::max(norm(begin), norm(end)),
               share = beyond / (sums.way + floor);
  if (share > sums.share) sums.share = share, sums.largest = open, sums.time = time;
  if (sums.allowed > restart_share * sums.way) sums.open = sums.integral = {}, sums.allowed = sums.way = 0;
}

}  // namespace

PathWatch::PathWatch(const scene::Scene& scene) {
  if (!scene.mbd) return;
  for (const scene::Body& body : scene.mbd->bodies) size_.push_back(gyration(body));
}

void PathWatch::record(const Exchange& exchange) {
  const double H = exchange.motion.window.length(), time = to_seconds(exchange.motion.window.end);
  for (const protocol::BodyMotion& m : exchange.motion.bodies) {
    if (m.body >= size_.size()) continue;
    Of& of = bodies_[m.body];
    add(of.displacement, m.end_pose.p_WB - m.begin_pose.p_WB, m.begin_twist.v_WB, m.end_twist.v_WB, H,
        resolved * (size_[m.body] + norm(m.end_pose.p_WB)), time);
    const Vec3d spin = (0.5 * H) * (m.begin_twist.w_WB + m.end_twist.w_WB);
    add(of.rotation, rotation_between(m.begin_pose.q_WB, m.end_pose.q_WB, spin), m.begin_twist.w_WB,
        m.end_twist.w_WB, H, resolved, time);
  }
}

void PathWatch::save_or_restore(Archive& archive, std::size_t bodies) {
  archive("path_watch", bodies_);
  const auto is_sound = [](const Sums& s) {
    return is_finite(s.open) && is_finite(s.integral) &&
           std::ranges::all_of(std::initializer_list<double>{s.allowed, s.way, s.share, s.largest, s.time},
                               [](double value) { return std::isfinite(value) && value >= 0; });
  };
  for (const auto& [index, of] : bodies_)
    archive.expect(index < bodies && is_sound(of.displacement) && is_sound(of.rotation), "path_watch",
                   "a sum is not finite or negative, or there is no such body");
}

}  // namespace tandem::launch
