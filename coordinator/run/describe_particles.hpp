// Describes the particles of a scene as text.
#pragma once

#include <string>
#include <vector>

#include "coordinator/run/dry_run.hpp"

namespace tandem::launch {

std::string describe_dem(const SceneFile& file, const DryRun* started);
std::string describe_sph(const SceneFile& file, const DryRun* started);

}  // namespace tandem::launch
