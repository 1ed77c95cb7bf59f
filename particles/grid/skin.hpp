// Thickness of the skin of a neighbour list. A list is valid until two spheres, or a sphere and a wall, may
// have approached by its skin. A thick skin needs few rebuilds, but lists many candidates that do not touch;
// every step tests them, and they take memory. The best skin depends on the speeds of the spheres and is
// chosen anew for each list.
//
// In units of a micro step without such candidates, a rebuild costs `rebuild_cost`. Candidates cost in
// proportion to the skin, `candidate_cost` at the usual one. A list of skin s lasts s / approach steps, where
// `approach` is the approach of two spheres per step, so that a step costs
//
//   rebuild_cost approach / s + candidate_cost s / usual
//
// The minimum is at s = sqrt(rebuild_cost / candidate_cost * usual * approach). On an H100 with 1 million
// spheres candidates cost twice that, on a CPU a fifth. All processors use the same costs, because the lists
// define the order in which forces are summed. docs/experiments/2026-11-skin.md has the measurements.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::scene {
struct Dem;
}

namespace tandem::particles {

inline constexpr double rebuild_cost = 13, candidate_cost = 0.1;  // [micro steps]

// Admissible skins of a run [m]. If the scene gives one, smallest and largest are equal to it.
struct SkinRange {
  double usual = 0;
  double smallest = 0, largest = 0;

  // The best skin where two spheres approach by `approach` [m] per step.
  TANDEM_HD double best(double approach) const {
    const double wanted = std::sqrt(rebuild_cost / candidate_cost * usual * approach);
    return wanted < smallest ? smallest : wanted > largest ? largest : wanted;
  }

  // Has a list with this skin been kept too long? Where spheres come to rest, the last list was made while
  // they still moved and would be kept forever. After `age` steps, in which two spheres approached by at most
  // `approached` [m], its needless candidates have cost more than a new list:
  //   candidate_cost age (skin - best(approached / age)) / usual > rebuild_cost
  // The code avoids roots and quotients, because every thread of a GPU evaluates it.
  TANDEM_HD bool outlived(double skin, double approached, std::uint32_t age) const {
    const double kept = candidate_cost * age, enough = kept * skin - rebuild_cost * usual;
    return enough > kept * smallest && enough * enough > rebuild_cost * usual * approached * kept;
  }
};

// Bound of the listed neighbours of a sphere with the largest skin, in a bed of equal spheres with 6 contacts
// each, plus a 64th for growth of the lists. It is at least the observed number (11 with the usual skin, 13
// with twice that), and with a thick skin the number that fills the space at the density 0.65 of random
// packings.
inline double most_neighbours(const SkinRange& skins) {
  if (!(skins.usual > 0)) return 0;
  const double usual_ones = skins.largest / skins.usual, reach = 1 + usual_ones / 8;  // [-], [diameters]
  return (1 + 1.0 / 64) * std::fmax(10 + 1.75 * usual_ones, 8 * 0.65 * reach * reach * reach);
}

// Contacts per sphere in such a bed, where a contact of two spheres counts once and a quarter of the spheres
// touch a wall.
inline constexpr double most_walls = 0.25, most_contacts = 1.125 * (6 / 2.0 + most_walls);

// Skins of a scene whose spheres have these radii [m].
SkinRange skins_of(const scene::Dem& dem, const std::vector<double>& radii);

}  // namespace tandem::particles
