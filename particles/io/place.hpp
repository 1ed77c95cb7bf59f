// The spheres of a packing at the start of a run.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "particles/geometry/surface.hpp"
#include "particles/io/fill.hpp"

namespace tandem::particles {

struct Placement {
  std::vector<Vec3d> position;  // of centres, world [m] (spheres x 3)
  std::vector<double> radius;   // [m] (spheres)
  double mass = 0;              // of all spheres [kg]
  double volume = 0;            // of the filled part of the region [m3]
  double void_fraction = 0;     // of that part [-]
  int sweeps = 0;               // in which the spheres were moved apart
};

// Places the spheres of a group whose fill is a packing: first at the sites of a hexagonal lattice, displaced
// at random, the larger spheres before the smaller ones; then they move apart until no sphere overlaps
// another one, a wall, or one of `others`. Bodies are at their poses of the scene. The result depends neither
// on the number of threads nor, up to rounding, on a rotation of the whole scene. Error{scene} where they do
// not fit.
Placement place(const scene::Scene& scene, std::size_t group, const std::vector<NamedMesh>& meshes,
                const std::vector<FixedSphere>& fixed, const Fill& others, unsigned threads);

}  // namespace tandem::particles
