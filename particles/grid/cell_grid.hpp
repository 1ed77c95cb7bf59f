// The cells into which spheres are sorted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/math/vec3.hpp"
#include "common/scene/model.hpp"
#include "particles/geometry/periods.hpp"

namespace tandem::particles {

// Regular cells over the domain, numbered in blocks of 4 x 4 x 4, so that cells near in space are near in
// memory.
struct CellGrid {
  Vec3d origin;             // [m]
  Vec3d inverse_cell;       // [1/m]
  std::int32_t cells[3]{};  // along x, y, z
  std::int32_t blocks[3]{};
  std::uint32_t total = 0;  // numbers in use, gaps of incomplete blocks included
  bool periodic[3]{};
  // Where cells are larger than requested: square of a distance beyond which two spheres cannot be in
  // contact, even if their positions, which are counted modulo 2^32, appear close [m2]. Otherwise 0: all
  // spheres of the searched cells are near enough.
  double apart2 = 0;

  // Of a cell [unit].
  Vec3f edge(double unit) const {
    return (1 / unit * Vec3d{1 / inverse_cell.x, 1 / inverse_cell.y, 1 / inverse_cell.z}).as<float>();
  }
  TANDEM_HD std::int32_t along(double x, int axis) const {
    const double c = (x - origin[axis]) * inverse_cell[axis];
    return static_cast<std::int32_t>(c);
  }
  // Does a cell exist along an axis? With `images` a periodic axis continues at its other end, by at most one
  // period; `c` then becomes the cell there, and `image` records the shift.
  template <bool images>
  TANDEM_HD bool exists(std::int32_t& c, int axis, Image& image) const {
    if (c >= 0 && c < cells[axis]) return true;
    if (!images || !periodic[axis]) return false;
    image = static_cast<Image>(image | (c < 0 ? image_below(axis) : image_above(axis)));
    c += c < 0 ? cells[axis] : -cells[axis];
    return true;
  }
  TANDEM_HD std::uint32_t number(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::int32_t block = ((z >> 2) * blocks[1] + (y >> 2)) * blocks[0] + (x >> 2);
    return static_cast<std::uint32_t>(block * 64 + (z & 3) * 16 + (y & 3) * 4 + (x & 3));
  }
};

// Number of cells that is worth its memory for this many spheres: some 16 million, or two for each sphere.
double most_cells(std::size_t spheres);

// Cells with an edge of at least `cell` [m] over the domain, a whole number of them along periodic axes, and
// at most some `most` of them; at most four times as many including those of blocks beyond the domain.
// Error{scene} for a period of fewer than three cells: a sphere could be in contact with two images of one
// neighbour.
CellGrid make_cell_grid(const scene::Box& domain, const Periods& periods, double cell, double most);

// A warning where the domain is so vast that cells are much wider than the edge `needed` [m], so that a
// rebuild of the lists compares spheres of these radii [m], those of the grid, with very many others;
// otherwise empty.
std::string warn_of_full_cells(const CellGrid& grid, const scene::Box& domain, double needed,
                               const std::vector<double>& radii);

}  // namespace tandem::particles
