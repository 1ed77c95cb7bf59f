// Shapes as triangles.
#pragma once

#include <string>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::scene {

// The file of a mesh or of the points of a hull; empty where the shape has none.
const std::string& file_of(const Geometry& geometry);
double scale_of(const Geometry& geometry);
// Length of a unit of the file along each of its axes [m].
Vec3d units_of(const Geometry& geometry);
Vec3d stretch_of(const Geometry& geometry);
// "0.001", or "0.001 and a stretch of [2, 1, 1]".
std::string scale_text(double scale, Vec3d stretch);

// Name under which the solvers receive the triangles of a shape of contact with a file: "BODY/SHAPE". Names
// of walls have no slash.
std::string contact_mesh_name(const Scene& scene, const Shape& shape);

// "cone", as in the scene.
std::string name_of(const Geometry& geometry);

// Whether the shape ends on all sides; a plane and a cylinder without a height do not.
bool is_bounded(const Geometry& geometry);

// Walls that the particle solver gets as triangles without a file: capsules, cones, hulls, height fields.
bool is_made_of_facets(const Geometry& geometry);

// The farthest that an inscribed polyhedron is inside the round surface [m]; 0 for all that is exact.
double deviation_of_facets(const Geometry& geometry);

// Triangles of a bounded shape in its own frame; round shapes get `segments` unless they have a number of
// their own. `in_file`: the triangles of its file. Throws Error{scene} with the path of the shape where the
// points of a hull are in one plane.
TriangleMesh mesh_of(const Shape& shape, const TriangleMesh& in_file, int segments,
                     const std::string& origin);

// What the particles know of a shape that is a wall: a surface of its kind, or a mesh that has the name of
// the wall and no file.
Wall wall_of(const Shape& shape);

}  // namespace tandem::scene
