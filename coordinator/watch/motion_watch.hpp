// Whether the answers of a multibody participant agree with each other: each window begins in the state in
// which the last one ended, also after a restart, and the frame for the results has the bodies in the state
// at the end of the window. Known for the boundary bodies, whose motion the participant sends.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "coordinator/watch/rigid_body.hpp"

namespace tandem::launch {

// A difference of two states of one body that should be equal.
struct StateDifference {
  double position = 0, rotation = 0;  // [m] [rad]
  double speed = 0, spin = 0;         // of velocity and angular velocity [m/s] [rad/s]
  double time = 0;                    // [s]
  // The largest of: position relative to the body's size, rotation in rad, and what the other two displace
  // and rotate in one window, likewise [-].
  double share = 0;
};

// `length` is that of a window [s].
StateDifference difference(const Pose& pose, const Twist& twist, const Pose& expected,
                           const Twist& expected_twist, double size, double length);

class MotionWatch {
 public:
  explicit MotionWatch(const scene::Scene& scene);

  // The state before the first window.
  void begin_with(const std::vector<protocol::BodyMotion>& boundary);
  // A window that was accepted.
  void record(const protocol::MotionSet& motion);
  // The bodies of a frame at the end of the last window.
  void observe(Nanoseconds now, const std::vector<protocol::BodyState>& bodies);
  // `bodies`: number of bodies of the scene.
  void save_or_restore(Archive& archive, std::size_t bodies);

  // By body. `share` is the sum over the run, the rest is the largest jump.
  struct Jumps {
    StateDifference largest;
    double sum = 0;  // of the shares of all windows [-]
  };
  const std::map<std::uint32_t, Jumps>& jumps() const { return jumps_; }
  // The largest difference between a frame and the motion, by body; bodies without one are left out.
  const std::map<std::uint32_t, StateDifference>& false_frames() const { return false_frames_; }

 private:
  void compare_begin(const protocol::BodyMotion& motion, std::size_t place, const Window& window);
  const protocol::BodyState* last_of(std::uint32_t body, std::size_t place) const;

  std::vector<double> size_;               // by body [m]
  double length_;                          // of a window of the scene [s]
  std::vector<protocol::BodyState> last_;  // at the end of the last window
  std::map<std::uint32_t, Jumps> jumps_;
  std::map<std::uint32_t, StateDifference> false_frames_;
};

}  // namespace tandem::launch
