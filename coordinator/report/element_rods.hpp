// Springs, ropes and cylinders of a scene as thin rods between their points, for the picture.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/report/frame.hpp"

namespace tandem::launch {

struct Rod {
  enum class Of { spring, rope, barrel, piston_rod } of = Of::spring;
  Vec3d a, b;         // world [m]
  double radius = 0;  // [m]
};

// `size` is that of the picture [m]. Elements on bodies whose place is not known are left out.
std::vector<Rod> element_rods(const scene::Scene& scene, const Frame& frame, double size);

}  // namespace tandem::launch
