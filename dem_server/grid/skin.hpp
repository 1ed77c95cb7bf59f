// How thick the skin of a neighbour list is. A list lives until two spheres, or a sphere and a wall, may have
// come nearer by its skin: a thick one is rebuilt seldom and holds many candidates that do not touch, which
// every step asks and memory keeps. What is best depends on how fast the spheres are, and is chosen anew for
// each list.
//
// In units of a micro step without such candidates: a rebuild costs `rebuild_cost`; candidates cost in
// proportion to the skin, `candidate_cost` for the usual one. A list of skin s lasts s / approach steps,
// where `approach` is by how much two come nearer in a step, so that a step costs
//
//   rebuild_cost approach / s + candidate_cost s / usual
//
// which is least for s = sqrt(rebuild_cost / candidate_cost * usual * approach). On an H100 with 1 million
// spheres candidates cost twice that, on a CPU a fifth. All processors share the costs: the lists are the
// order in which forces are summed. docs/performance.md has the measurements.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::scene {
struct Dem;
}

namespace tandem::dem {

inline constexpr double rebuild_cost = 13, candidate_cost = 0.1;  // [micro steps]

// What skins a run's lists may have [m]. Where the scene gives one, smallest and largest are that.
struct SkinRange {
  double usual = 0;
  double smallest = 0, largest = 0;

  // The best one where two come nearer by `approach` [m] in a step.
  TANDEM_HD double best(double approach) const {
    const double wanted = std::sqrt(rebuild_cost / candidate_cost * usual * approach);
    return wanted < smallest ? smallest : wanted > largest ? largest : wanted;
  }

  // Has a list of that skin been kept too long? Where spheres come to rest, the last list was made while they
  // still moved, and would stay. After `age` steps, in which two came nearer by at most `approached` [m], its
  // needless candidates have cost more than a new list:
  //   candidate_cost age (skin - best(approached / age)) / usual > rebuild_cost
  // without a root or a quotient: every thread of a GPU asks.
  TANDEM_HD bool outlived(double skin, double approached, std::uint32_t age) const {
    const double kept = candidate_cost * age, enough = kept * skin - rebuild_cost * usual;
    return enough > kept * smallest && enough * enough > rebuild_cost * usual * approached * kept;
  }
};

// Neighbours of a sphere within reach of the largest skin, inside a bed of spheres of one size that touch 6
// others, with a 64th for the lists' growth: no fewer than have been seen (11 with the usual skin, 13 with
// twice that), and where the skin is thick as many as fill the space, of which spheres packed at random take
// up 0.65.
inline double most_neighbours(const SkinRange& skins) {
  if (!(skins.usual > 0)) return 0;
  const double usual_ones = skins.largest / skins.usual, reach = 1 + usual_ones / 8;  // [-], [diameters]
  return (1 + 1.0 / 64) * std::fmax(10 + 1.75 * usual_ones, 8 * 0.65 * reach * reach * reach);
}

// Contacts in such a bed, those of two spheres being one, with a quarter of the spheres at a wall.
inline constexpr double most_walls = 0.25, most_contacts = 1.125 * (6 / 2.0 + most_walls);

// Of a scene whose spheres have these radii [m].
SkinRange skins_of(const scene::Dem& dem, const std::vector<double>& radii);

}  // namespace tandem::dem
