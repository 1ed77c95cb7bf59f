// Numbers in the environment that change how a back end works, and no result.
#pragma once

#include <cstdint>
#include <optional>

namespace tandem::particles {

// The number that an environment variable holds; none where the variable is not set. Error{usage} for any
// other text.
std::optional<std::uint32_t> setting(const char* name);

}  // namespace tandem::particles
