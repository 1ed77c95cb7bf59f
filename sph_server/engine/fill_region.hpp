// A liquid at rest below a level inside a closed mesh, at the start of a run.
#pragma once

#include <optional>

#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

// The level lies perpendicular to gravity, `height` above the lowest point of the region; or it is where the
// liquid has the `volume`. Exactly one of them is given.
struct FillAmount {
  std::optional<double> height;  // [m]
  std::optional<double> volume;  // [m3]
  // By how much the volumes of the solids that were taken out of the region exceed that of their union [m3].
  double common = 0;
};

// Volume of the part of a closed mesh where dot(x, up) < level [m3]. up: a unit vector.
double volume_below(const TriangleMesh& region, Vec3d up, double level);

// Depth of the liquid: of its level above the lowest point of the region [m]. gravity: not zero.
// Error{scene} as fill_region.
double depth_of(const TriangleMesh& region, Vec3d gravity, const FillAmount& amount);

// Particles that fill the region up to the level, at rest under the hydrostatic pressure that their
// compression states. Their number is that of the liquid's mass. Where a cubic lattice fits between the
// walls, as in a box of whole spacings, it is taken; elsewhere the particles are packed under a lid until
// walls and particles fill the space evenly (LiquidEngine::pack). Walls: those of `setup` with these poses;
// they enclose the region, up to the level at least. region: in world axes, closed up to the level; where it
// has cavities, their triangles are wound the other way.
// Error{scene} without gravity, for a mesh that is open below the level, for an amount that is not in the
// mesh, and for less than one particle.
// axes: of the region, which the lattice follows as far as gravity lets it.
LiquidState fill_region(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses,
                        const TriangleMesh& region, const FillAmount& amount,
                        const Mat3d& axes = Mat3d::identity());

}  // namespace tandem::sph
