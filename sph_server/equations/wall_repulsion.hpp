// Repulsion by the nearest point of all walls, within a quarter of a spacing. The pressure at a wall follows
// from how the particle came: one that comes along the plane of a sheet over its edge is on the sheet without
// any pressure. Particles of a liquid at rest are half a spacing from walls and are not repelled.
#pragma once

#include "common/host_device.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

struct WallRepulsion {
  double range = 0;      // [m]
  double stiffness = 0;  // of a spring per mass [1/s2]

  // The spring stops a quarter of the speed of sound; its period is some 17 of the longest steps.
  static WallRepulsion of(const Liquid& l) {
    const double rate = l.sound_speed / l.spacing;
    return {0.25 * l.spacing, rate * rate};
  }
  // Along the line from the wall to the particle, at a distance below the range [m/s2].
  TANDEM_HD double acceleration(double distance) const { return stiffness * (range - distance); }
};

}  // namespace tandem::sph
