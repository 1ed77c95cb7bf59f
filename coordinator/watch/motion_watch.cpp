#include "coordinator/watch/motion_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tandem::launch {
namespace {

bool same_bits(const Pose& pose, const Twist& twist, const Pose& other, const Twist& other_twist) {
  return std::memcmp(&pose, &other, sizeof pose) == 0 && std::memcmp(&twist, &other_twist, sizeof twist) == 0;
}

bool is_sound(const StateDifference& d) {
  return std::ranges::all_of(
      std::initializer_list<double>{d.position, d.rotation, d.speed, d.spin, d.time, d.share},
      [](double value) { return std::isfinite(value) && value >= 0; });
}

}  // namespace

StateDifference difference(const Pose& pose, const Twist& twist, const Pose& expected,
                           const Twist& expected_twist, double size, double length) {
  StateDifference d;
  d.position = norm(pose.p_WB - expected.p_WB);
  d.rotation = norm(rotation_vector(pose.q_WB * expected.q_WB.conjugate()));
  d.speed = norm(twist.v_WB - expected_twist.v_WB);
  d.spin = norm(twist.w_WB - expected_twist.w_WB);
  d.share = std::max({d.position / size, d.rotation, length * d.speed / size, length * d.spin});
  return d;
}

MotionWatch::MotionWatch(const scene::Scene& scene) : length_(scene.coupling.window) {
  if (!scene.mbd) return;
  for (const scene::Body& body : scene.mbd->bodies) size_.push_back(gyration(body));
}

void MotionWatch::begin_with(const std::vector<protocol::BodyMotion>& boundary) {
  last_.clear();
  for (const protocol::BodyMotion& motion : boundary)
    last_.push_back({motion.body, 0, motion.end_pose, motion.end_twist});
}

// Participants send the bodies in the same order in each window.
const protocol::BodyState* MotionWatch::last_of(std::uint32_t body, std::size_t place) const {
  if (place < last_.size() && last_[place].body == body) return &last_[place];
  const auto found = std::ranges::find(last_, body, &protocol::BodyState::body);
  return found == last_.end() ? nullptr : &*found;
}

void MotionWatch::compare_begin(const protocol::BodyMotion& motion, std::size_t place, const Window& window) {
  const protocol::BodyState* last = last_of(motion.body, place);
  if (!last || motion.body >= size_.size() ||
      same_bits(motion.begin_pose, motion.begin_twist, last->pose, last->twist))
    return;
  StateDifference jump = difference(motion.begin_pose, motion.begin_twist, last->pose, last->twist,
                                    size_[motion.body], window.length());
  jump.time = to_seconds(window.begin);
  Jumps& jumps = jumps_[motion.body];
  jumps.sum += jump.share;
  if (jump.share > jumps.largest.share) jumps.largest = jump;
}

void MotionWatch::record(const protocol::MotionSet& motion) {
  const std::vector<protocol::BodyMotion>& bodies = motion.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) compare_begin(bodies[i], i, motion.window);
  last_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    last_[i] = {bodies[i].body, 0, bodies[i].end_pose, bodies[i].end_twist};
}

void MotionWatch::observe(Nanoseconds now, const std::vector<protocol::BodyState>& bodies) {
  for (const protocol::BodyState& last : last_) {
    const auto found = std::ranges::lower_bound(bodies, last.body, {}, &protocol::BodyState::body);
    if (found == bodies.end() || found->body != last.body || last.body >= size_.size() ||
        same_bits(found->pose, found->twist, last.pose, last.twist))
      continue;
    StateDifference d =
        difference(found->pose, found->twist, last.pose, last.twist, size_[last.body], length_);
    d.time = to_seconds(now);
    StateDifference& largest = false_frames_[last.body];
    if (d.share > largest.share) largest = d;
  }
}

void MotionWatch::save_or_restore(Archive& archive, std::size_t bodies) {
  archive("motion_watch/last", last_);
  archive("motion_watch/jumps", jumps_);
  archive("motion_watch/false_frames", false_frames_);
  for (const protocol::BodyState& last : last_)
    archive.expect(last.body < bodies && is_finite(last.pose.p_WB) && std::isfinite(last.pose.q_WB.norm2()) &&
                       is_finite(last.twist.v_WB) && is_finite(last.twist.w_WB),
                   "motion_watch/last", "a state is not finite, or there is no such body");
  for (const auto& [body, jumps] : jumps_)
    archive.expect(body < bodies && is_sound(jumps.largest) && std::isfinite(jumps.sum) && jumps.sum >= 0,
                   "motion_watch/jumps", "a jump is not finite or negative, or there is no such body");
  for (const auto& [body, d] : false_frames_)
    archive.expect(body < bodies && is_sound(d), "motion_watch/false_frames",
                   "a difference is not finite or negative, or there is no such body");
}

}  // namespace tandem::launch
