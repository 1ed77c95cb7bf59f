// `tandem run`.
#pragma once

#include "launch/coordinator/options.hpp"

namespace tandem::launch {

// Runs a scene and leaves its results in a folder. Returns the exit status; throws Error for what is wrong
// before there is a folder.
int run(const RunOptions& options);

}  // namespace tandem::launch
