// `tandem run`.
#pragma once

#include "coordinator/scene/options.hpp"

namespace tandem::launch {

class Controller;

// Runs a scene and writes its results to a folder. Returns the exit status; throws Error for faults found
// before the folder exists. A program that embeds this may pass its own `controller`, which replaces that of
// the options.
int run(const RunOptions& options, Controller* controller = nullptr);

}  // namespace tandem::launch
