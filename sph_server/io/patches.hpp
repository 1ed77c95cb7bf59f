// Patches of walls on which a sensor measures the pressure.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::sph {

// A mesh in two parts, with the triangle that each of their triangles is a piece of.
struct CutMesh {
  TriangleMesh inside, outside;
  std::vector<std::size_t> inside_of, outside_of;
};

// The part of a mesh within a box of this size, whose middle and axes are those of `pose`, and the rest.
// Triangles that the faces of the box cut become several.
CutMesh cut_by_box(const TriangleMesh& mesh, const Pose& pose, Vec3d size);

// The box of a sensor of pressure with an area: as deep on both sides as half its longer edge.
Vec3d patch_size(const scene::RectangleShape& area);

// Area of a mesh as seen along an axis, a unit vector [m2].
double area_along(const TriangleMesh& mesh, Vec3d axis);

}  // namespace tandem::sph
