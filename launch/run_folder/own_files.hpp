// The names of the files that a run leaves in its folder: all of them, and no others. What has another name
// in there is somebody else's.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "launch/results/series/frame_file.hpp"

namespace tandem::launch {

// Identity of the run, and the lock that it holds while it goes on.
inline constexpr const char* marker_name = "tandem_run.json";
// Space on the disk that is kept for the last summary.
inline constexpr const char* reserve_name = "summary.json.reserve";
inline constexpr const char* summary_name = "summary.json";
// Of the restart files.
inline constexpr const char* checkpoint_folder = "checkpoint";
inline constexpr const char* half_steps_folder = "half_steps";

// Whether a run writes a file of this name, which is relative to its folder: "frames/particles_000012.h5".
bool is_own_file(const std::filesystem::path& name);

// Removes a run's files from its folder but the marker, and the folders that become empty by that. Links are
// removed and never followed. Returns what else is in there, relative to the folder, at most ten names.
// Error{resource} where a file cannot be removed.
std::vector<std::string> remove_own_files(const std::filesystem::path& folder);

}  // namespace tandem::launch
