// Places of a liquid's particles in a region before they are relaxed: a lattice that is cut at walls.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

// Axes of the lattice, unit vectors. The third is against gravity.
struct LatticeAxes {
  Vec3d axis[3];
};
// The first one is as near to an axis of `region_axes` (its columns) as gravity lets it.
LatticeAxes lattice_axes(Vec3d up, const Mat3d& region_axes);

// How a lattice is cut.
struct LatticeSpace {
  LatticeAxes axes;
  double surface = 0;  // height along the third axis up to which it reaches [m]
  // Layers have equal masses at rest below the surface, rather than equal heights.
  bool compressed = true;
};

// Each cell of the lattice has the volume of a particle. A cell that walls cut has as many parts as it is cut
// into; each part has a particle or none, so that the mass near every point is right within half a particle
// of what the walls leave there (error diffusion [FloydSteinberg1976] over the parts that no wall
// separates).
//
// region: closed up to the surface, its normals outwards; walls: those in and around it, with their poses;
// particles: how many there shall be. Error{scene} where they have no room, or too much.
std::vector<Vec3d> cut_lattice(const TriangleMesh& region, const Walls& walls, const Liquid& liquid,
                               const LatticeSpace& space, std::size_t particles, unsigned threads);

// The lattice if no wall cuts a cell of it and it has that many particles, which are then in equilibrium;
// otherwise nothing.
std::vector<Vec3d> whole_lattice(const TriangleMesh& region, const Walls& walls, const Liquid& liquid,
                                 const LatticeSpace& space, std::size_t particles, unsigned threads);

}  // namespace tandem::sph
