// Whether a multibody participant starts in the state of the scene.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// Pose and velocity of bodies at t = 0 where the scene fixes them: those of bodies without joints, and the
// poses in trees of joints without prescribed motion. Loops are assembled, and move their bodies; a static
// equilibrium moves all.
class StartOfBodies {
 public:
  explicit StartOfBodies(const scene::Scene& scene);

  // The bodies with walls, from the answer to `configure`. Throws Error{protocol} with body, value and
  // expected value, and where the bodies are not those with walls.
  void expect(const std::vector<protocol::BodyMotion>& boundary) const;
  // The same for the first frame, which has all bodies.
  void expect(const std::vector<protocol::BodyState>& bodies) const;

 private:
  void expect_state(std::uint32_t body, const Pose& pose, const Twist& twist) const;

  const std::vector<scene::Body> bodies_;
  std::vector<bool> has_walls_, pose_known_, twist_known_;
};

}  // namespace tandem::launch
