// Repulsion by the nearest point of all walls, within a quarter of a spacing. The pressure at a wall follows
// from how the particle came: one that comes along the plane of a sheet over its edge is on the sheet without
// any pressure. Particles of a liquid at rest are half a spacing from walls and are not repelled.
//
// The push is damped and never pulls: a spring without damping would give a particle back some more than it
// brought, by the error of the steps (docs/experiments/2026-11-sph-corners.md).
//
// In a slit or a tip that is narrower than half a spacing a second wall repels as well: the nearest one alone
// would push in turns to one side and to the other, which drives the particle through a wall in the end.
#pragma once

#include <cmath>

#include "common/host_device.hpp"
#include "common/math/vec3.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

struct WallRepulsion {
  double range = 0;      // [m]
  double stiffness = 0;  // of a spring per mass [1/s2]

  // The spring stops a quarter of the speed of sound; its period is some 14 of the longest steps.
  static WallRepulsion of(const Liquid& l) {
    const double rate = l.sound_speed / l.spacing;
    return {0.25 * l.spacing, rate * rate};
  }
  // Along the line from the wall to the particle, at a distance below the range [m/s2].
  TANDEM_HD double acceleration(double distance) const { return stiffness * (range - distance); }

  // Of the nearest wall, on a particle that moves away from it with this speed [m/s2].
  TANDEM_HD double of_nearest(double distance, double away) const {
    return std::fmax(0.0, acceleration(distance) - damping(distance, 0.5) * away);
  }

  // Share of a second wall, with the directions from both walls to the particle, and whether the nearest
  // point of the second one is in the middle of a facet, along its normal [-]. Zero where both are one wall:
  // the rest of it, or the other side of an edge.
  TANDEM_HD static double share(Vec3d from_first, Vec3d from_second, Vec3d normal_of_second) {
    const double alike = dot(from_first, from_second),
                 upright = part((std::fabs(dot(from_second, normal_of_second)) - 0.9) / 0.1),
                 opposite = part((-alike - 0.3) / 0.4);
    return part(1 - alike) * (upright > opposite ? upright : opposite);
  }
  // Damping of the push of a wall, with the share `share` of it [1/s].
  TANDEM_HD double damping(double distance, double share) const {
    constexpr double ratio = 0.2;  // of a particle between two walls, to that without vibrations [-]
    return 2 * ratio * std::sqrt(2 * stiffness) * share * (range - distance) / range;
  }

 private:
  TANDEM_HD static double part(double value) { return value < 0 ? 0 : value > 1 ? 1 : value; }
};

}  // namespace tandem::sph
