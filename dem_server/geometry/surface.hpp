// The walls of all bodies as facets in body frames, with a grid per body that is built once.
// "Body slot" numbers the bodies that carry walls, in scene order, with the ground first (slot 0, identity pose).
#pragma once

#include <cstdint>
#include <vector>

#include "common/math/rotation.hpp"
#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::dem {

enum class FacetKind : std::uint32_t { triangle, plane };

// A triangle a, b, c, or a plane through a with unit normal b (solid on the side that the normal leaves).
struct Facet {
  Vec3d a, b, c;            // body frame [m]; plane: b is the normal [-]
  FacetKind kind = FacetKind::triangle;
  std::uint32_t patch = 0;  // facets that meet smoothly share a patch, which a sphere feels as one surface
};

struct Patch {
  std::uint32_t slot = 0;      // body slot
  std::uint32_t material = 0;
};

// Facets of one body that come within reach of each cell of a regular grid; a position outside the grid is near none.
struct FacetGrid {
  Vec3d origin;                      // [m]
  double cell = 0;                   // edge [m]
  std::int32_t cells[3]{};           // along x, y, z; all 0: the body has no triangles
  std::uint32_t first_cell = 0;      // where this grid's cells begin in `cell_start`
  std::uint32_t first_plane = 0, planes = 0;  // the body's planes, which are near everywhere (indices in `facets`)
};

struct Surface {
  std::vector<Facet> facets;               // triangles and planes of all slots
  std::vector<Patch> patches;
  std::vector<FacetGrid> grids;            // one per slot
  std::vector<std::uint32_t> cell_start;   // (total cells + 1) offsets into cell_facet
  std::vector<std::uint32_t> cell_facet;   // facet indices, ascending in each cell
  std::vector<BodyId> slot_body;           // body of each slot; slot 0 is `ground`
  std::vector<double> slot_extent;         // largest distance of a facet's point from the body's origin [m]; planes count 0 and are allowed on moving bodies
  double reach = 0;                        // grid guarantee: all facets within this distance of a point are in its cell [m]
};

// `reach` = largest radius + skin. Error{scene} for degenerate or unusable meshes, naming wall and triangle.
Surface make_surface(const scene::Scene& scene, const std::vector<protocol::NamedMesh>& meshes, double reach);

}  // namespace tandem::dem
