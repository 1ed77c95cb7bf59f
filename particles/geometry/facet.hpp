// Plain data of walls, for host and device.
#pragma once

#include <cstdint>

#include "common/math/rotation.hpp"

namespace tandem::particles {

enum class FacetKind : std::uint32_t { triangle, plane, cylinder, disc, ball };

//   triangle   a, b, c are its corners, `normal` is along (b - a) x (c - a)
//   plane      through a; solid on the side that the normal points away from
//   cylinder   the lateral surface alone, about the axis `normal` through its centre a
//   disc       flat, about its centre a, perpendicular to `normal`
//   ball       the surface of a sphere about a
// b holds the dimensions of the last three. A sphere's centre on the axis has no radial direction; the unit
// vector c, perpendicular to the axis, replaces it. At the centre of a ball, `normal` does.
struct alignas(16) Facet {
  Vec3d a, b, c;  // body frame [m]
  Vec3d normal;   // unit [-]
  FacetKind kind = FacetKind::triangle;
  std::uint32_t patch = 0;  // facets that join smoothly share a patch; a sphere has one contact with a patch
  std::uint32_t body = 0;   // boundary body index

  TANDEM_HD double radius() const { return b.x; }       // [m]
  TANDEM_HD double half_height() const { return b.y; }  // of a cylinder, may be infinite [m]
};

// The vertices of the triangle must not be collinear.
inline Facet triangle_facet(Vec3d a, Vec3d b, Vec3d c) {
  return {a, b, c, normalized(cross(b - a, c - a))};
}

struct Patch {
  std::uint32_t material = 0;
};

// Facets of one body that come within reach of each cell of a regular grid; a position outside the grid is
// near none of them.
struct FacetGrid {
  Vec3d origin;                  // [m]
  double cell = 0;               // edge [m]
  std::int32_t cells[3]{};       // along x, y, z; all 0: the body has no facets to list
  std::uint32_t first_cell = 0;  // where this grid's cells begin in `cell_start`
  // The few facets of the body that are not in the grid and are tested everywhere (indices in `facets`)
  std::uint32_t first_analytic = 0, analytic = 0;
};

// The facets to test for a sphere: those of its grid cell, then those outside the grid. Indices ascend.
struct NearFacets {
  const std::uint32_t* listed = nullptr;
  int listed_count = 0;
  std::uint32_t first_analytic = 0;
  int count = 0;

  TANDEM_HD std::uint32_t operator[](int i) const {
    return i < listed_count ? listed[i] : first_analytic + static_cast<std::uint32_t>(i - listed_count);
  }
};

// p: centre in the frame of the grid's body [m].
TANDEM_HD inline NearFacets near_facets(const FacetGrid& grid, const std::uint32_t* cell_start,
                                        const std::uint32_t* cell_facet, Vec3d p) {
  NearFacets near{nullptr, 0, grid.first_analytic, static_cast<int>(grid.analytic)};
  if (grid.cells[0] == 0) return near;
  const double inverse = 1.0 / grid.cell;
  const double x = (p.x - grid.origin.x) * inverse, y = (p.y - grid.origin.y) * inverse,
               z = (p.z - grid.origin.z) * inverse;
  // In this form a NaN is outside.
  const bool inside =
      x >= 0 && x < grid.cells[0] && y >= 0 && y < grid.cells[1] && z >= 0 && z < grid.cells[2];
  if (!inside) return near;
  const std::int64_t row = static_cast<std::int64_t>(z) * grid.cells[1] + static_cast<std::int64_t>(y);
  const std::int64_t cell = grid.first_cell + row * grid.cells[0] + static_cast<std::int64_t>(x);
  near.listed = cell_facet + cell_start[cell];
  near.listed_count = static_cast<int>(cell_start[cell + 1] - cell_start[cell]);
  near.count += near.listed_count;
  return near;
}

}  // namespace tandem::particles
