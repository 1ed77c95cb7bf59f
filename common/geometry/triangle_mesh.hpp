// A triangle mesh in its own frame, and the built-in shapes that become meshes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/math/rotation.hpp"

namespace tandem {

struct TriangleMesh {
  std::vector<Vec3d> vertices;                          // [m] (vertices x 3)
  std::vector<std::array<std::uint32_t, 3>> triangles;  // vertex indices (triangles x 3)
};

struct NamedMesh {
  std::string name;  // of the wall or the shape; the mesh is in the shape's frame, scale applied
  TriangleMesh mesh;
};

// Box of full edge lengths `size` about the origin, without the faces named in `open` ("+x", "-x", ... "-z").
// Each face is two triangles.
TriangleMesh box_mesh(Vec3d size, const std::vector<std::string>& open = {});

// Cylinder about the z axis, centred at the origin, with a side of `segments` quads; without the ends named
// in `open` ("+z", "-z").
TriangleMesh cylinder_mesh(double radius, double height, int segments,
                           const std::vector<std::string>& open = {});

// Sphere about the origin, with `segments` meridians and half as many zones.
TriangleMesh sphere_mesh(double radius, int segments);

// Scales `mesh`, then transforms it by `pose`.
TriangleMesh transformed(TriangleMesh mesh, const Pose& pose, double scale = 1);

// Triangles that cannot be used: index out of range, non-finite vertex, or area below 1e-12 of the longest
// edge squared.
std::vector<std::size_t> degenerate_triangles(const TriangleMesh& mesh);

}  // namespace tandem
