// Closed parts of a mesh, and which of them lie inside which.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

struct ClosedPart {
  TriangleMesh mesh;
  Vec3d low, high;    // bounds [m]
  double volume = 0;  // negative where it winds inwards [m3]
};
ClosedPart closed_part(TriangleMesh mesh);

struct Nesting {
  std::vector<std::vector<std::size_t>> around;  // of each part, those that contain it
  // Pairs of a part and one that it is partly inside of, or of which nobody can tell: it is too thin.
  std::vector<std::pair<std::size_t, std::size_t>> unclear;

  bool is_unclear(std::size_t part) const;
};

// Judged by points inside each part, which all have to agree: its corners may be on the surface of another
// part, as those of a flush pocket are.
Nesting nesting_of(const std::vector<ClosedPart>& parts);

// "[1, 2, 3]", in six digits.
std::string point_text(Vec3d p);
// "the closed part at [1, 2, 3]"
std::string part_text(const ClosedPart& part);
// A sentence for a pair of `unclear`.
std::string why_unclear(const ClosedPart& inner, const ClosedPart& outer);

}  // namespace tandem
