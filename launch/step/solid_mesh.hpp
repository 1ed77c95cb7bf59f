// Triangles of solids, joined by their topology: a closed solid has a closed mesh.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::step {

struct SolidMesh {
  TriangleMesh mesh;  // in the frame of the product [m], corners rounded to float as in an STL file
  std::vector<TopoDS_Face> faces;
  std::vector<std::size_t> first;  // first triangle of each face, and the number of all triangles
  double deviation = 0;            // measured: from surface points amid the triangles to these [m]
};

// `deviation` [m]: the mesh is made finer until the measured one is no larger. Throws Refusal.
SolidMesh mesh_of_solids(const TopoDS_Shape& shape, double deviation);

}  // namespace tandem::step
