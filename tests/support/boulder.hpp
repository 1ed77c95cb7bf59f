// A scene with a sphere that is fifteen times as large as the others and has very many neighbours.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "particles/state/particles.hpp"

namespace tandem::test {

// Makes the first sphere a boulder; the others fall onto it from all sides, in two layers.
inline void make_boulder(particles::Spheres& s) {
  const Vec3d centre{0, 0, 0.3};
  constexpr double boulder = 0.06, grain = 0.004;  // radii [m]
  constexpr std::size_t in_layer = 400;
  for (std::size_t i = 0; i < s.size(); ++i) {
    // Successive spheres differ by the golden angle and by equal steps in height.
    const double n = static_cast<double>(i % in_layer), height = 1 - (2 * n + 1) / in_layer,
                 angle = n * std::numbers::pi * (3 - std::sqrt(5.0)), across = std::sqrt(1 - height * height);
    const double away = boulder + grain + (i < in_layer ? 0.0005 : 0.0105);
    const Vec3d outwards{across * std::cos(angle), across * std::sin(angle), height};
    s.position[i] = i == 0 ? centre : centre + away * outwards;
    s.velocity[i] = i == 0 ? Vec3d{} : -0.5 * outwards;
    s.radius[i] = i == 0 ? boulder : grain;
  }
}

}  // namespace tandem::test
