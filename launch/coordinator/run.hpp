// `tandem run`.
#pragma once

#include "launch/coordinator/options.hpp"

namespace tandem::launch {

class Controller;

// Runs a scene and leaves its results in a folder. Returns the exit status; throws Error for what is wrong
// before there is a folder.
// A program that embeds this may bring its own `controller`, which then takes the place of that of the
// options.
int run(const RunOptions& options, Controller* controller = nullptr);

}  // namespace tandem::launch
