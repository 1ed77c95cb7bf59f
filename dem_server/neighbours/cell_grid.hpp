// The cells that spheres are sorted into.
#pragma once

#include <cstdint>

#include "common/math/vec3.hpp"
#include "common/scene/model.hpp"

namespace tandem::dem {

// Regular cells over the domain, numbered in blocks of 4 x 4 x 4 so that cells near in space are near in
// memory.
struct CellGrid {
  Vec3d origin;             // [m]
  double inverse_cell = 0;  // [1/m]
  std::int32_t cells[3]{};  // along x, y, z
  std::int32_t blocks[3]{};
  std::uint32_t total = 0;  // numbers in use, gaps of incomplete blocks included

  TANDEM_HD std::int32_t along(double x, int axis) const {
    const double c = (x - origin[axis]) * inverse_cell;
    return static_cast<std::int32_t>(c);
  }
  TANDEM_HD std::uint32_t number(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::int32_t block = ((z >> 2) * blocks[1] + (y >> 2)) * blocks[0] + (x >> 2);
    return static_cast<std::uint32_t>(block * 64 + (z & 3) * 16 + (y & 3) * 4 + (x & 3));
  }
};

// Slots of the spheres in one cell: [begin, end).
struct CellRange {
  std::uint32_t begin = 0, end = 0;
};

// Cells of at least the edge `cell` [m] over the domain.
CellGrid make_cell_grid(const scene::Box& domain, double cell);

}  // namespace tandem::dem
