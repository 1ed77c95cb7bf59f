// What an engineer checks of each machine element before a run: sizes, limits and the state at the start.
#pragma once

#include <string>

#include "common/scene/model.hpp"

namespace tandem::launch {

// One line for each force, with a heading; empty where the scene has none.
std::string describe_elements(const scene::Scene& scene);

}  // namespace tandem::launch
