// Whether the bodies of the frames are where the joints of the scene let them be, whether prescribed
// coordinates follow their motions, and whether the coordinates that a frame gives are those of its poses.
// Each joint is judged by the relative pose of its two frames alone, whatever the participant's method.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/motion_function.hpp"
#include "coordinator/schemes/archive.hpp"

namespace tandem::launch {

// What is wrong with a joint.
enum class JointFault : std::uint32_t { distance, rotation, motion, coordinate };

// The largest violation of one joint.
struct JointViolation {
  double share = 0;  // a length relative to the size of the machine, or an angle [-] [rad]
  double open = 0;   // [m] or [rad]
  double time = 0;   // [s]
  JointFault fault{};
  std::uint32_t is_angle = 0;  // whether `open` is one

  // "its two sides are 0.4 m apart where it lets them not move"
  std::string text() const;
};

class JointWatch {
 public:
  explicit JointWatch(const scene::Scene& scene);

  void observe(const protocol::BodiesFrame& frame);
  void save_or_restore(Archive& archive);

  bool judges() const { return !joints_.empty(); }
  // By joint; joints without a violation are left out.
  const std::map<std::uint32_t, JointViolation>& violations() const { return violations_; }

 private:
  // The frame of a joint on one of its bodies, in the body's frame.
  struct Side {
    BodyId body;
    Vec3d point, axis, across;
  };
  struct Watched {
    std::uint32_t index = 0;
    scene::Joint joint;
    Side parent, child;
    std::optional<scene::MotionFunction> motion;
  };
  // The same in the world.
  struct Placed {
    Vec3d point, axis, across;
  };

  static Side side_of(const scene::Mbd& mbd, BodyId body, Vec3d point, const scene::Joint& joint);
  static std::optional<Placed> placed(const Side& side, const std::vector<protocol::BodyState>& bodies);
  void judge(const Watched& watched, const Placed& a, const Placed& b, const protocol::BodiesFrame& frame);
  void take(const Watched& watched, JointFault fault, bool is_angle, double open, double time);

  double size_ = 0;  // of the machine [m]
  std::vector<Watched> joints_;
  std::map<std::uint32_t, JointViolation> violations_;
};

}  // namespace tandem::launch
