// `tandem ps` and `tandem stop`.
#pragma once

#include <chrono>
#include <string>

#include "launch/run_folder/run_state.hpp"

namespace tandem::launch {

// The runs of this user on this host, as a table for people.
std::string list_of_runs();
// The same as one JSON array.
std::string list_of_runs_as_json();

// Asks a run to stop after its window, as Ctrl-C does, and waits until it has. `run`: its pid or its folder.
// Error{usage} where there is no such run that goes on here; Error{timeout} where it does not end within
// `patience`.
void stop_run(const std::string& run, std::chrono::milliseconds patience);

}  // namespace tandem::launch
