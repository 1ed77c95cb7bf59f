// The state of a folder's run for a reader: only this file concludes `died`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "coordinator/run_folder/marker.hpp"

namespace tandem::launch {

struct RunState {
  std::optional<Marker> marker;
  nlohmann::json summary = nlohmann::json::object();  // summary.json; empty where there is none
  // A status of docs/verdict.md: `died` where the summary says `running` and the marker's lock is free, or
  // the process is gone. Empty where there is neither summary nor marker.
  std::string status;
};
RunState read_run(const std::filesystem::path& folder);

}  // namespace tandem::launch
