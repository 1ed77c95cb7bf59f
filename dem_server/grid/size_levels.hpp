// Spheres of very unlike sizes, in levels: each has cells of its own, as wide as its largest sphere needs, so
// that a boulder does not fill the cells of the grains around it (Ogarko and Luding, A fast multilevel
// algorithm for contact detection of arbitrarily polydisperse objects, Comput. Phys. Commun. 183, 931, 2012).
// A sphere looks into the cells of every level, and finds the smaller ones as well as the larger: each of a
// pair lists the other.
//
// All spheres are sorted by the cells of the finest level, so that what is near in space is near in memory
// whatever its size; those of coarser levels stand in lists of their own besides.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dem_server/grid/cell_grid.hpp"
#include "dem_server/grid/skin.hpp"

namespace tandem::dem {

// Code for more than one is for scenes that have them.
enum class Levels { one, many };

// The level above a finer one.
struct CoarseLevel {
  CellGrid grid;
  double largest = 0;            // radius of its spheres, and room for its rounding to quanta [m]
  std::uint32_t first_cell = 0;  // its cells follow those of the level below
};

struct SizeLevels {
  CellGrid finest[2];               // for skins up to the usual one, and for larger ones
  double largest_of_finest = 0;     // radius, likewise [m]
  std::vector<CoarseLevel> coarse;  // sizes ascending; empty where one level does for all

  std::uint32_t coarse_cells() const {
    return coarse.empty() ? 0 : coarse.back().first_cell + coarse.back().grid.total;
  }
  // Of both grids: in a thin domain the one of narrower cells need not have more.
  std::uint32_t finest_cells() const { return std::max(finest[0].total, finest[1].total); }
  std::size_t cells() const { return std::size_t{finest_cells()} + coarse_cells(); }
};

// Largest radius of each level, ascending. A level's spheres are at most twice as large as its smallest ones,
// but for few that are smaller still: to look for those among the larger ones costs less than cells of their
// own would.
std::vector<double> limits_of_levels(const std::vector<double>& radii);

// Levels of which a large sphere would meet a cell from both ends of a short period are parts of the next
// one. `range`: of adhesion, a part of the largest skin [m]. Error{scene} for a period of fewer than three
// cells of the largest spheres.
SizeLevels make_size_levels(const scene::Box& domain, const Periods& periods,
                            const std::vector<double>& radii, const SkinRange& skins, double range);

// Into how many cells on either side of its own a sphere has to look whose partners are within `reach` [m],
// or as many as there are.
TANDEM_HD inline std::int32_t cells_within(const CellGrid& grid, int axis, double reach) {
  const std::int32_t all = grid.cells[axis] > 1 ? grid.cells[axis] - 1 : 1;
  const double away = reach * grid.inverse_cell[axis];
  return away < all ? static_cast<std::int32_t>(away) + 1 : all;
}

}  // namespace tandem::dem
