// The names of the files that a run writes to its folder: exactly these. A file with another name belongs to
// the user.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/results/series/frame_file.hpp"

namespace tandem::launch {

// Identity of the run, and the lock that it holds while it is in progress.
inline constexpr const char* marker_name = "tandem_run.json";
// Disk space reserved for the last summary.
inline constexpr const char* reserve_name = "summary.json.reserve";
inline constexpr const char* summary_name = "summary.json";
// First and last frames between the programs of a failed run (docs/replay.md).
inline constexpr const char* last_windows_name = "last_windows.rec";
// Folder of the restart files.
inline constexpr const char* checkpoint_folder = "checkpoint";
inline constexpr const char* half_steps_folder = "half_steps";
// Folder of the copy of the scene, and that copy.
inline constexpr const char* scene_folder = "scene";
inline constexpr const char* kept_scene_name = "scene.json";

// Folder of the pictures of `tandem movie` before they are a film.
inline constexpr const char* stills_folder = "movie_frames";

// Files that stay open during the run, and grow.
inline constexpr std::array appended_files{"run.log",     "bodies.csv", "joints.csv", "elements.csv",
                                           "windows.csv", "border.csv", "control.csv"};

// Whether a run writes a file of this name, relative to its folder: "frames/particles_000012.h5".
bool is_own_file(const std::filesystem::path& name);

// Removes a run's files from its folder except the marker, and the folders that become empty. Links are
// removed and never followed. Returns the remaining names, relative to the folder, at most ten. Throws
// Error{resource} where a file cannot be removed.
std::vector<std::string> remove_own_files(const std::filesystem::path& folder);

}  // namespace tandem::launch
