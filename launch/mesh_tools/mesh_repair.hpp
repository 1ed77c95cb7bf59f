// Repairs a triangle mesh, and says what was done and how far the surface moved.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

struct RepairOptions {
  std::optional<double> weld;  // corners this near become one [m]; absent: 1e-5 of the diagonal
  std::optional<double> fill;  // openings up to this width are filled [m]; absent: all
};

struct RepairedMesh {
  TriangleMesh mesh;
  std::vector<std::string> done;  // one line for each kind of repair
  // Closed parts of which nobody can tell whether they are cavities, a sentence for each.
  std::vector<std::string> unclear;
  double deviation = 0;  // largest distance between the surfaces, from each to the other [m]
};

// In this order: corners that are nearly at one place become one; triangles without area and duplicates are
// left out, and both of opposite ones where they are a wall between two solids; edges are divided at corners
// that lie on them; triangles wind as their neighbours; openings are filled by triangles about their middle;
// closed parts turn outwards (see turn_outwards()). Self-intersections stay.
RepairedMesh repaired(const TriangleMesh& mesh, const RepairOptions& options);

// Largest distance found from corners, middles of edges and middles of triangles of each mesh to the other
// one [m].
double distance_between(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace tandem::launch
