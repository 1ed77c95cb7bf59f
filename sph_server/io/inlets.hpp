// Inlets of the liquid. Behind the liquid that comes in there is a piston, a wall at the inlet, which moves
// with it. When it has moved by the thickness of a layer of particles, it jumps back to its start, and a
// layer of particles takes the space between: what the liquid feels stays the same, since a wall acts as
// liquid that continues behind it.
#pragma once

#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"
#include "particles/geometry/path.hpp"

namespace tandem::sph {

struct Inlet {
  scene::LiquidInlet of;
  std::vector<Vec3d> site;  // of the particles of a layer, in the frame of the inlet, at z = 0 [m]
  double thickness = 0;     // of a layer, so that its volume is that of its particles [m]
  TriangleMesh piston;      // at z = 0, in the frame of the inlet

  double end() const;                             // infinite without an end [s]
  double due(std::uint64_t layer) const;          // when a layer comes in, the first one being 0 [s]
  std::uint64_t layers_until(double time) const;  // that are due by then
  // Of the piston at a time, after so many layers.
  particles::BodyPose pose(double time, std::uint64_t layers) const;
};

// Of a validated scene.
std::vector<Inlet> inlets_of(const scene::Sph& sph);

}  // namespace tandem::sph
