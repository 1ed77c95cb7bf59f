// A drum with holes as a mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::benchmark {

inline void add_triangle(TriangleMesh& m, Vec3d a, Vec3d b, Vec3d c) {
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.insert(m.vertices.end(), {a, b, c});
  m.triangles.push_back({first, first + 1, first + 2});
}
inline void add_quad(TriangleMesh& m, Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  add_triangle(m, a, b, c);
  add_triangle(m, a, c, d);
}

// A drum about the z axis with around x along octagonal holes of this radius; thickness 0: a sheet.
inline TriangleMesh drum(double radius, int around, int along, double hole, double thickness) {
  TriangleMesh m;
  const double pitch = 2 * std::numbers::pi * radius / around;
  constexpr int corners = 8;
  const auto at = [radius](double u, double z, double r) {
    return Vec3d{r * std::cos(u / radius), r * std::sin(u / radius), z};
  };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < along; ++j)
      for (int s = 0; s < corners; ++s) {
        Vec3d inner[2][2], outer[2][2];  // end of the piece, side of the sheet
        for (int e = 0; e < 2; ++e) {
          const double angle = 2 * std::numbers::pi * (s + e) / corners, c = std::cos(angle),
                       n = std::sin(angle), u = (i + 0.5) * pitch, z = (j + 0.5) * pitch,
                       square = pitch / 2 / std::max(std::fabs(c), std::fabs(n));
          for (int side = 0; side < 2; ++side) {
            const double r = radius + side * thickness;
            inner[e][side] = at(u + hole * c, z + hole * n, r);
            outer[e][side] = at(u + square * c, z + square * n, r);
          }
        }
        if (thickness == 0) {
          add_quad(m, inner[0][0], outer[0][0], outer[1][0], inner[1][0]);
          continue;
        }
        add_quad(m, inner[0][0], inner[1][0], outer[1][0], outer[0][0]);
        add_quad(m, inner[0][1], outer[0][1], outer[1][1], inner[1][1]);
        add_quad(m, inner[0][0], inner[0][1], inner[1][1], inner[1][0]);
        const bool low =
            outer[0][0].z +
            outer[1][0].z<1e-6 * pitch, high = outer[0][0].z + outer[1][0].z>(2 * along - 1e-6) * pitch;
        if (low || high) add_quad(m, outer[0][0], outer[1][0], outer[1][1], outer[0][1]);
      }
  return m;
}

}  // namespace tandem::benchmark
