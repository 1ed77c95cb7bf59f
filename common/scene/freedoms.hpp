// In which directions a body can move, as far as joints with the ground decide it alone.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

struct Freedom {
  bool fixed = false;  // to the ground, or with a prescribed motion
  // Velocity and angular velocity of the frame of the body per rate of its one revolute or prismatic joint
  // with the ground, in the pose of the file; none: all six directions.
  std::optional<std::array<double, 6>> single;
};
// Of each body. Other joints and neighbours are left out: they only add inertia.
std::vector<Freedom> freedoms_of(const Mbd& mbd);

}  // namespace tandem::scene
