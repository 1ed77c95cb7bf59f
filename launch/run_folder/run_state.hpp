// How the run of a folder is doing, as a reader finds it: the one place that concludes `died`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "launch/run_folder/marker.hpp"

namespace tandem::launch {

struct RunState {
  std::optional<Marker> marker;
  nlohmann::json summary = nlohmann::json::object();  // summary.json; empty where there is none
  // A word of docs/verdict.md: `died` where the summary says `running` and the marker's lock is free, or the
  // process is gone. Empty where there is neither summary nor marker.
  std::string status;
};
RunState read_run(const std::filesystem::path& folder);

}  // namespace tandem::launch
