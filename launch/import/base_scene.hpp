// The scene that bodies and joints are imported into.
#pragma once

#include <string>

#include "launch/import/import.hpp"

namespace tandem::launch {

// That of --into, or an empty one of this name. Throws Error{scene} where --into is no scene with particles.
nlohmann::ordered_json base_scene(const ImportOptions& options, const std::string& name);

}  // namespace tandem::launch
