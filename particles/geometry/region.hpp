// Regions of space that are measured, and that particles leave through.
#pragma once

#include <cstdint>

#include "particles/geometry/path.hpp"

namespace tandem::particles {

// Where particles leave: beyond the plane through `min` with this normal, or in a box [min, max).
struct OutletRegion {
  Vec3d min, max;  // [m]
  Vec3d normal;    // [-]
  bool half_space = false;

  TANDEM_HD bool contains(Vec3d x) const {
    if (half_space) return dot(normal, x - min) > 0;
    return x.x >= min.x && x.x < max.x && x.y >= min.y && x.y < max.y && x.z >= min.z && x.z < max.z;
  }
};

// The place of a sensor at one instant: a box about p, or a cylinder about p along the third axis of R.
struct MeasuredRegion {
  Vec3d p;     // [m]
  Mat3d R;     // region to world [-]
  Vec3d half;  // half of the edges of a box; of a cylinder the radius, the same, half of the height [m]
  bool round = false;  // a cylinder
  Vec3d flow;          // unit vector in the world along which the flow is measured; zero: none
  BodyPose body;       // with which it moves

  // Without the faces at the far ends, so that regions side by side share no particle.
  TANDEM_HD bool contains(Vec3d x) const {
    const Vec3d local = R.transpose_times(x - p);
    if (!(local.z >= -half.z && local.z < half.z)) return false;
    if (round) return local.x * local.x + local.y * local.y < half.x * half.x;
    return local.x >= -half.x && local.x < half.x && local.y >= -half.y && local.y < half.y;
  }
};

// Sums over the particles whose centre is in a region.
struct RegionSums {
  std::uint64_t count = 0;
  double mass = 0;            // [kg]
  double volume = 0;          // [m3]
  Vec3d moment;               // sum of mass times position [kg m]
  Vec3d momentum;             // [kg m/s]
  double kinetic_energy = 0;  // [J]
  double flow_momentum = 0;   // relative to the region, along `flow` [kg m/s]
};

}  // namespace tandem::particles
