// The particles of a liquid at the start.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

// The sites of one box: the middles of cubes of one spacing.
struct Lattice {
  scene::Box box;
  std::size_t fill = 0;   // place in Liquid::fill
  std::size_t first = 0;  // index of the first site
  int count[3]{};
  Vec3d step;  // [m]

  // Index of a site, by its numbers along the axes.
  std::size_t site(const int* number) const {
    return first +
           (static_cast<std::size_t>(number[2]) * static_cast<std::size_t>(count[1]) +
            static_cast<std::size_t>(number[1])) *
               static_cast<std::size_t>(count[0]) +
           static_cast<std::size_t>(number[0]);
  }
};
// Of the boxes of a validated scene. Boxes that touch are one liquid.
std::vector<scene::Box> boxes_of(const scene::Liquid& liquid);
std::vector<Lattice> lattices_of(const scene::Liquid& liquid, double spacing);

// Where particles are before the liquid is compressed.
struct Sites {
  std::vector<Vec3d> position;  // [m] (n), box by box, in each x fastest
  // Set by measure_columns().
  std::vector<double> above;  // height of the surface above the site, against gravity [m] (n)
  std::vector<double> depth;  // the same above the lower end of the column of liquid through the site [m] (n)

  double deepest() const;  // [m]
};
Sites sites_of(const scene::Liquid& liquid, double spacing);

// Places, velocities and compressions of the particles. At hydrostatic pressure a column keeps its mass: it
// is as much lower as its own weight compresses it.
LiquidState fill_of(const Sites& sites, const scene::Liquid& liquid, const Liquid& properties,
                    Vec3d velocity);

// A region that the liquid fills up to a level: the inside of a wall.
struct FilledInside : Filling {  // without the insides of closed walls that are in the region
  std::size_t fill = 0;          // place in Liquid::fill
  double depth = 0;              // [m]
  std::size_t particles = 0;     // volume / spacing^3
};
// Error{scene} where the amount is not in the wall, where it is open below the level, and where another wall
// passes through it there.
std::vector<FilledInside> insides_of(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);

// Is x in that liquid? up: against gravity.
bool is_below(const FilledInside& filled, Vec3d x, Vec3d up);

// Places of the particles of one of them, in `setup` with these poses of its walls. Error{scene} as
// fill_places().
FilledPlaces places_of(const FilledInside& filled, const LiquidSetup& setup,
                       const std::vector<particles::BodyPose>& poses, const AfterStep& after_step = {});
// By place_of_fill(); those that are not there are computed.
using PlacesByFill = std::map<std::string, std::vector<Vec3d>>;

// All particles at the start: those of the boxes, then those of each inside, in the order of the fills.
// `sites`: of the boxes; poses: of the walls of `setup`. Error{scene} as fill_places(), and where two fills
// overlap.
LiquidState liquid_at_start(const scene::Scene& scene, const Sites& sites,
                            const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                            const std::vector<particles::BodyPose>& poses, Vec3d velocity,
                            const PlacesByFill& places);

// Place of an entry of the fills of the liquid, for messages.
std::string place_of_fill(std::size_t fill);

}  // namespace tandem::sph
