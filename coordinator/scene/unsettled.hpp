// Spheres that do not come to rest before the start: which, where and how fast.
#pragma once

#include <string>

#include "coordinator/scene/scene_file.hpp"
#include "particles/io/fill.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct Unsettled {
  const SceneFile& file;
  const scene::Scene& scene;         // that settles
  const particles::Fill& fill;       // by the ids of the frame
  protocol::ParticlesFrame spheres;  // as they are
  double bound = 0;                  // of the kinetic energy of a sphere at rest [J]
};

// "; 30 of 400 spheres have more than that, from [0, 0, 0] to [1, 1, 1] m; the fastest is sphere 3 of
// 'grains' at [0, 0, 0.2] m with 0.3 m/s, 0.006 m from wall 'cone' of 'ground'". Empty where none has.
std::string what_moves(const Unsettled& unsettled);

// Draws the spheres in the colours of their speeds. Throws the errors of draw_preview().
void draw_unsettled(const std::filesystem::path& picture, const Unsettled& unsettled);

}  // namespace tandem::launch
