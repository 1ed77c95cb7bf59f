// The walls of all bodies as facets in body frames, with one grid per body that is built once. A boundary
// body index numbers the bodies with walls in scene order, after the ground, which has index 0 and the
// identity pose. A belt, a wall whose surface moves along itself, has an index of its own after that of its
// body's other walls.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/ids.hpp"
#include "common/scene/model.hpp"
#include "particles/geometry/facet.hpp"

namespace tandem::particles {

inline constexpr std::uint32_t ground_index = 0;
inline constexpr std::uint32_t no_belt = ~0u;

// A sphere of a group that never moves: a ball wall of the ground.
struct FixedSphere {
  Vec3d position;  // [m]
  double radius = 0;
  std::uint32_t material = 0;  // index in dem.materials
  std::uint32_t group = 0;     // index in dem.particles
};

struct Surface {
  std::vector<Facet> facets;  // of all bodies
  std::vector<Patch> patches;
  std::vector<std::uint32_t> patch_wall;  // index in dem.walls of each patch's wall, for messages; of fixed
                                          // spheres that of their group in dem.particles, after the walls
  std::vector<FacetGrid> grids;           // one per body
  std::vector<std::uint32_t> cell_start;  // (total cells + 1) offsets into cell_facet
  std::vector<std::uint32_t> cell_facet;  // facet indices, ascending in each cell
  std::vector<BodyId> boundary_bodies;    // of each boundary body index; the first is `ground`
  std::vector<std::uint32_t> belt_wall;   // of each boundary body index the wall in dem.walls, or no_belt
  std::vector<double> body_extent;  // bound of the distance of a facet's point from the body's origin [m];
                                    // infinite with planes and endless cylinders
  // All facets within this distance of a point are in its grid cell, or tested everywhere [m]
  double reach = 0;

  bool has_belts() const {
    return std::ranges::any_of(belt_wall, [](std::uint32_t wall) { return wall != no_belt; });
  }
};

// The arrays of a surface on the processor that runs the spheres.
struct SurfaceView {
  std::uint32_t bodies = 0;  // with walls, ground included
  const Facet* facets = nullptr;
  const Patch* patches = nullptr;
  const FacetGrid* grids = nullptr;
  const std::uint32_t *cell_start = nullptr, *cell_facet = nullptr;
};

// `reach` = largest radius + largest skin. Each fixed sphere is a patch. In a periodic domain its images that
// spheres in the domain may touch belong to the same patch, so that a contact continues with its history when
// the sphere reenters through the opposite face. Error{scene} for degenerate or unusable meshes, naming wall
// and triangle.
Surface make_surface(const scene::Scene& scene, const std::vector<NamedMesh>& meshes, double reach,
                     std::span<const FixedSphere> fixed = {});

// Error{scene} where a moving sphere of radius `largest` [m] could touch two images of one fixed sphere at
// once: both images are one patch, which has only one contact.
void expect_single_images(std::span<const FixedSphere> fixed, const scene::Dem& dem, double largest);

// The wall or group of spheres that a patch belongs to, for messages.
std::string patch_name(const Surface& surface, std::uint32_t patch, const scene::Dem& dem);

}  // namespace tandem::particles
