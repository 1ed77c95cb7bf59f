// The particles of a liquid at the start.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

// Where particles are before the liquid is compressed: the middles of cubes of one spacing.
struct Sites {
  std::vector<Vec3d> position;  // [m] (n), box by box, in each x fastest
  std::vector<double> above;    // of the liquid above, against gravity [m] (n)
  std::vector<double> depth;    // of the whole column of liquid through the site [m] (n)

  double deepest() const;  // [m]
};
// The boxes of a validated scene. Boxes that touch are one liquid.
Sites sites_of(const scene::Liquid& liquid, double spacing, Vec3d gravity);

// Places, velocities and compressions of the particles. At hydrostatic pressure a column keeps its mass: it
// is as much lower as its own weight compresses it.
LiquidState fill_of(const Sites& sites, const scene::Liquid& liquid, const Liquid& properties);

}  // namespace tandem::sph
