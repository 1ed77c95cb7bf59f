#include "dem_server/neighbours/cell_grid.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/scene/fault.hpp"

namespace tandem::dem {
namespace {

// Whole cells of a period.
std::int32_t cells_of(double period, double least, double cell, int axis) {
  constexpr double fewest = 3;
  if (period < fewest * least)
    throw Error(ErrorCode::scene,
                "the domain is " + scene::rounded(period) + " m long along the periodic axis " + "xyz"[axis],
                "dem.domain",
                "give it at least " + scene::rounded(fewest * least) +
                    " m: three times the largest diameter and the skin of the neighbour list");
  return static_cast<std::int32_t>(std::max(fewest, std::floor(period / cell)));
}

}  // namespace

CellGrid make_cell_grid(const scene::Box& domain, const Periods& periods, double least) {
  // A domain that is vast beside its spheres gets larger cells, so that empty space costs little memory.
  constexpr double most_cells = 16e6;
  const Vec3d size = domain.max - domain.min;
  const double cell = std::max(least, std::cbrt(size.x * size.y * size.z / most_cells));
  CellGrid g;
  g.origin = domain.min;
  for (int a = 0; a < 3; ++a) {
    g.periodic[a] = periods.length[a] > 0;
    if (g.periodic[a]) {
      g.cells[a] = cells_of(periods.length[a], least, cell, a);
      // A little less, so that no place before the domain's end is rounded into a cell beyond the last.
      g.inverse_cell[a] = g.cells[a] / periods.length[a] * (1 - 1e-15);
    } else {
      g.inverse_cell[a] = 1 / cell;
      g.cells[a] = static_cast<std::int32_t>(size[a] / cell) + 1;
    }
    if (1 / g.inverse_cell[a] > 1.0001 * least) g.apart2 = 4 * least * least;
    g.blocks[a] = (g.cells[a] + 3) / 4;
  }
  g.total = static_cast<std::uint32_t>(g.blocks[0] * g.blocks[1] * g.blocks[2] * 64);
  return g;
}

}  // namespace tandem::dem
