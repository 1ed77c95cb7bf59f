// Shapes of contact whose size does not fit the machine: mostly a file in another unit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

struct Unit {
  const char* name;
  double metres;
};
// The unit in which something `width` wide would be at most `most` wide: mm, or else micrometres [m].
std::optional<Unit> unit_that_fits(double width, double most);
// "is the file in mm? then give "scale": 0.001"; `scale` is that of now.
std::string question_of_scale(double width, double most, double scale);

// `machine`: extent of the places of bodies and joints [m].
void review_contact_sizes(const SceneFile& file, double machine, std::vector<std::string>& warnings);

}  // namespace tandem::launch
