// The particles of a liquid at the start.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "sph_server/engine/fill_region.hpp"
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
std::vector<scene::Box> boxes_of(const scene::Liquid& liquid);
Sites sites_of(const scene::Liquid& liquid, double spacing, Vec3d gravity);

// Places, velocities and compressions of the particles. At hydrostatic pressure a column keeps its mass: it
// is as much lower as its own weight compresses it.
LiquidState fill_of(const Sites& sites, const scene::Liquid& liquid, const Liquid& properties);

// A region that the liquid fills up to a level: the inside of a wall.
struct FilledInside {
  std::size_t fill = 0;  // place in Liquid::fill
  // In the world, without the insides of closed walls that are in it.
  TriangleMesh region;
  FillAmount amount;
  double depth = 0;           // [m]
  std::size_t particles = 0;  // volume / spacing^3
};
// Error{scene} where the amount is not in the wall, where it is open below the level, and where another wall
// passes through it there.
std::vector<FilledInside> insides_of(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);

// Is x in that liquid? up: against gravity.
bool is_below(const FilledInside& filled, Vec3d x, Vec3d up);

// All particles at the start: those of the boxes, then those of each inside, in the order of the fills.
// `sites`: of the boxes; poses: of the walls of `setup`. Error{scene} as fill_region, and where two fills
// overlap.
LiquidState liquid_at_start(const scene::Scene& scene, const Sites& sites,
                            const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                            const std::vector<particles::BodyPose>& poses);

// Place of an entry of the fills of the liquid, for messages.
std::string place_of_fill(std::size_t fill);

}  // namespace tandem::sph
