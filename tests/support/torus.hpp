// A closed mesh with a hole.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::test {

// A ring about the z axis: radius of its middle, radius of its tube, and the number of faces around both.
inline TriangleMesh torus(double ring, double tube, std::uint32_t around, std::uint32_t across) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across,
                   rho = ring + tube * std::cos(b);
      mesh.vertices.push_back({rho * std::cos(a), rho * std::sin(a), tube * std::sin(b)});
      const auto at = [&](std::uint32_t k, std::uint32_t l) { return (k % around) * across + l % across; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

}  // namespace tandem::test
