// Levels of spheres with very different sizes: each level has cells of its own, as wide as its largest sphere
// needs, so that a boulder does not enlarge the cells of the grains around it (V. Ogarko, S. Luding: "A fast
// multilevel algorithm for contact detection of arbitrarily polydisperse objects", Computer Physics
// Communications 183 (2012) 931). A sphere searches the cells of every level and finds smaller and larger
// spheres: each of a pair lists the other.
//
// All spheres are sorted by the cells of the finest level, so that spheres near in space are near in memory
// whatever their size. Those of coarser levels are also listed by cells of their own level.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "particles/grid/cell_grid.hpp"
#include "particles/grid/skin.hpp"

namespace tandem::particles {

// `many` is separate code, used only in scenes that have several levels.
enum class Levels { one, many };

// A level above a finer one.
struct CoarseLevel {
  CellGrid grid;
  double largest = 0;            // radius of its spheres, rounding to quanta included [m]
  std::uint32_t first_cell = 0;  // its cells follow those of the level below
};

struct SizeLevels {
  CellGrid finest[2];               // for skins up to the usual one, and for larger ones
  double largest_of_finest = 0;     // radius, rounding included [m]
  std::vector<CoarseLevel> coarse;  // ascending sizes; empty where one level suffices

  std::uint32_t coarse_cells() const {
    return coarse.empty() ? 0 : coarse.back().first_cell + coarse.back().grid.total;
  }
  // The larger number of the two grids: in a thin domain the grid with narrower cells may have fewer.
  std::uint32_t finest_cells() const { return std::max(finest[0].total, finest[1].total); }
  std::size_t cells() const { return std::size_t{finest_cells()} + coarse_cells(); }
};

// Largest radius of each level, ascending. The spheres of a level are at most twice as large as its smallest
// ones, except for a few even smaller spheres, for which cells of their own would cost more than searching
// them among the larger ones.
std::vector<double> limits_of_levels(const std::vector<double>& radii);

// A level whose cells a large sphere would reach from both ends of a short period is merged into the next
// one. `range`: of adhesion, a part of the largest skin [m]. Error{scene} for a period of fewer than three
// cells of the largest spheres.
SizeLevels make_size_levels(const scene::Box& domain, const Periods& periods,
                            const std::vector<double>& radii, const SkinRange& skins, double range);

// Number of cells on either side of its own that a sphere has to search for partners within `reach` [m], at
// most as many as there are.
TANDEM_HD inline std::int32_t cells_within(const CellGrid& grid, int axis, double reach) {
  const std::int32_t all = grid.cells[axis] > 1 ? grid.cells[axis] - 1 : 1;
  const double away = reach * grid.inverse_cell[axis];
  return away < all ? static_cast<std::int32_t>(away) + 1 : all;
}

}  // namespace tandem::particles
