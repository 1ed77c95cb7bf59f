#include "dem_server/neighbours/cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::dem {

CellGrid make_cell_grid(const scene::Box& domain, double cell) {
  // A domain that is vast beside its spheres gets larger cells, so that empty space costs little memory.
  constexpr double most_cells = 16e6;
  const Vec3d size = domain.max - domain.min;
  cell = std::max(cell, std::cbrt(size.x * size.y * size.z / most_cells));
  CellGrid g;
  g.origin = domain.min;
  g.inverse_cell = 1 / cell;
  for (int a = 0; a < 3; ++a) {
    g.cells[a] = static_cast<std::int32_t>(size[a] / cell) + 1;
    g.blocks[a] = (g.cells[a] + 3) / 4;
  }
  g.total = static_cast<std::uint32_t>(g.blocks[0] * g.blocks[1] * g.blocks[2] * 64);
  return g;
}

}  // namespace tandem::dem
