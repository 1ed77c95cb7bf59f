// One wall in the form used by WallWatch (wall_watch.hpp): a surface of triangles or a plane, in the frame of
// its body, with the data for detecting whether surfaces pass through each other or are in contact.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/bounds.hpp"
#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::launch {

struct WallSurface {
  const scene::Wall* wall = nullptr;
  bool plane = false;
  Vec3d point, normal;                              // plane
  TriangleMesh mesh;                                // any other shape; vertices at one place are one vertex
  std::vector<std::array<std::uint32_t, 2>> edges;  // of the mesh, each once
  std::vector<std::array<bool, 3>> sharp;           // side k of a triangle, from corner k on (triangles)
  bool closed = false;                              // every edge has two triangles: the surface has an inside
  // Displacement of each vertex per metre of shrinking: to a distance of one metre from the planes of all
  // its triangles, on their inner side. A surface that is not closed has no inner side and shrinks at its
  // rims, within its triangles.
  std::vector<Vec3d> shrink;  // [-] (vertices)
  // Half of the mean thickness of the enclosed volume, which for sheet metal is that of the sheet: beyond
  // it the sides would pass through each other.
  double most_shrink = 0;  // [m]
  Vec3d centre, half;      // of the box around it [m]
  double radius = 0;       // of the sphere about `centre` [m]
  double thickness = 0;    // smallest edge of the box in the frame of the shape [m]
};

// Throws Error{internal} where the mesh of a wall is missing.
WallSurface make_surface(const scene::Wall& wall, const scene::Scene& scene,
                         const std::vector<NamedMesh>& meshes);

// Whether a point is inside a closed surface with its vertices at `at`, in the same frame. Uses all
// triangles.
bool is_inside(Vec3d point, const WallSurface& surface, const std::vector<Vec3d>& at);

}  // namespace tandem::launch
