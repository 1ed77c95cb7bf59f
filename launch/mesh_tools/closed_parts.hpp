// Closed parts of a mesh: which way they wind, and which lie inside which.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

struct TurnedParts {
  std::size_t outwards = 0, inwards = 0;  // inwards: cavities
  std::vector<std::string> unclear;       // sentences: parts of which nobody can tell, which stay as they are
};

// `part` numbers the part of each triangle, of which all wind alike. A closed part that is inside no other
// one then winds outwards. One inside another closed part keeps its winding relative to that one: if it is
// opposite, the part is a cavity (or a solid in a cavity); if not, why_not_solid() says so.
TurnedParts turn_outwards(TriangleMesh& mesh, const std::vector<std::size_t>& part);

}  // namespace tandem::launch
