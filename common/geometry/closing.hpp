// Does a mesh enclose a solid, although its triangles do not join exactly?
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

enum class Closure {
  solid,    // closed, perhaps with corners on edges of other triangles
  flipped,  // closed, but for the direction of triangles
  slit,     // with openings narrower than a width
  open      // with a wider opening, or something else, see why_not_solid()
};

struct Closing {
  Closure closure = Closure::open;
  TriangleMesh mesh;  // corners nearer than the tolerance are one
  double width = 0;   // of the largest opening: root of its area [m]
  std::string why;    // what is wrong, where closure is neither solid nor open
};

struct Opening {
  double width = 0;  // root of its area [m]
  Vec3d at;          // one of its corners [m]
};
struct Openings {
  std::optional<Opening> widest;
  std::optional<Vec3d> flipped;  // where triangles that join wind in different directions [m]
};
// The openings of a mesh with a corner for which counts(corner). Corners at one place are one.
Openings openings_of(const TriangleMesh& mesh, const std::function<bool(Vec3d)>& counts);

// tolerance: within which corners are the same [m]; width: below which an opening is a slit [m].
Closing closing_of(const TriangleMesh& mesh, double tolerance, double width);

}  // namespace tandem
