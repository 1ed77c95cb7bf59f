#pragma once

#include <string>

namespace tandem::scene {

// The published schema (draft 7), compiled into the programs.
const std::string& schema();

}  // namespace tandem::scene
