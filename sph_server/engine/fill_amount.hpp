// How much liquid is in a closed mesh: volumes below a level, the level of a volume, the number of particles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/geometry/triangle_mesh.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

// The level lies perpendicular to gravity, `height` above the lowest point of the region; or it is where the
// liquid has the `volume`. Exactly one of them is given.
struct FillAmount {
  std::optional<double> height = {};  // [m]
  std::optional<double> volume = {};  // [m3]
  std::optional<double> mass = {};    // from which the volume follows, for messages [kg]
  // By how much the volumes of the solids that were taken out of the region exceed that of their union [m3].
  double common = 0;
};

// The nearest whole number, down from a half also where rounding makes it a little more.
std::int64_t nearest_whole(double x);

// Volume of the part of a closed mesh where dot(x, up) < level [m3]. up: a unit vector.
double volume_below(const TriangleMesh& region, Vec3d up, double level);

// Depth of the liquid: of its level above the lowest point of the region [m]. gravity: not zero.
// Error{scene} without gravity, for a mesh that is open below the level, and for an amount that is not in the
// mesh.
double depth_of(const TriangleMesh& region, Vec3d gravity, const FillAmount& amount);

// The liquid at rest in a region.
struct FilledPart {
  TriangleMesh region;  // its normals outwards
  Vec3d up;             // against gravity, a unit vector
  // Height of the surface along `up`: below the level by as much as the liquid is compressed by its own
  // weight, at most half a percent of its depth with the speed of sound by rule [m].
  double surface = 0;
  double level = 0, low = 0;  // heights of the level and of the lowest point along `up` [m]
  std::size_t particles = 0;  // those of the mass of the volume below the level, to the nearest
};
// Error{scene} as depth_of(), and for less than one particle.
FilledPart filled_part(const Liquid& liquid, const TriangleMesh& region, const FillAmount& amount);

}  // namespace tandem::sph
