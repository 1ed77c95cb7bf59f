// Shapes of contact whose size does not fit the machine: mostly a file in another unit.
#pragma once

#include <string>
#include <vector>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// `machine`: extent of the places of bodies and joints [m].
void review_contact_sizes(const SceneFile& file, double machine, std::vector<std::string>& warnings);

}  // namespace tandem::launch
