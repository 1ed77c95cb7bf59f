// The state of the spheres. Positions and velocities are double in every precision: at 1 m from the origin a
// single-precision coordinate resolves 6e-8 m, and a grain that creeps 3e-9 m per step would never move.
//
//   Place    centre (double) | radius | material      read of every candidate neighbour
//   Motion   velocity (double) | spin | id            read of neighbours in contact
//
// Both are double buffered: a step reads one side and writes the other, so no sphere sees a half-updated
// neighbour.
#pragma once

#include <cstdint>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::dem {

template <class Real>
struct alignas(16) Place {
  Vec3d x;                 // centre [m]
  Real radius = 0;         // [m]
  std::uint32_t kind = 0;  // see Parameters::kinds
};

template <class Real>
struct alignas(8) Motion {
  Vec3d v;               // velocity [m/s]; leapfrog: half a step behind the position
  Vec3<Real> w;          // spin [rad/s]
  std::uint32_t id = 0;  // as numbered at the start
};

// A sphere that left the domain stays in the arrays, parked where nothing can reach it.
inline constexpr double parked = 1e30;
TANDEM_HD inline bool is_parked(Vec3d x) {
  return x.x == parked;
}

// Spheres on the host, in order of id.
struct Spheres {
  std::vector<Vec3d> position;          // [m] (n x 3)
  std::vector<Vec3d> velocity;          // [m/s] (n x 3)
  std::vector<Vec3d> spin;              // [rad/s] (n x 3)
  std::vector<double> radius;           // [m] (n)
  std::vector<std::uint32_t> material;  // (n)
  std::vector<std::uint32_t> id;        // (n)
  std::size_t size() const { return id.size(); }
};

}  // namespace tandem::dem
