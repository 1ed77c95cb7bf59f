// Names that bodies and joints cannot have.
#pragma once

#include <string>
#include <vector>

namespace tandem::scene {

// Parts before the first dot of a check's `of` that are not names of bodies or joints, and the first column
// of the results.
inline const std::vector<std::string>& reserved_body_names() {
  static const std::vector<std::string> names{"ground", "summary", "time"};
  return names;
}

}  // namespace tandem::scene
