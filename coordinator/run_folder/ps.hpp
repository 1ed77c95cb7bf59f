// `tandem ps` and `tandem stop`.
#pragma once

#include <chrono>
#include <string>

#include "coordinator/run_folder/run_state.hpp"

namespace tandem::launch {

// The runs of this user on this host, as a table for people.
std::string list_of_runs();
// The same as one JSON array.
std::string list_of_runs_as_json();

// Requests a run to stop after its window, as Ctrl-C does, and waits for its end. `run`: its pid or its
// folder. Throws Error{usage} where no such run is in progress on this host; Error{timeout} where it does not
// end within `patience`.
void stop_run(const std::string& run, std::chrono::milliseconds patience);

}  // namespace tandem::launch
