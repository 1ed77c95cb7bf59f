// `tandem study`.
//
// The folder contains scenes/KEY.json and runs/KEY/ of each run, results.csv, reading.txt and study.png. A
// second call runs only the missing runs.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

struct StudyOptions {
  std::filesystem::path file, folder;
  int jobs = 0;  // concurrent runs; 0: as many as the cores allow
  // Commands of servers that replace ours; absent: those of the scene, or ours.
  std::optional<std::string> mbd_server, dem_server, sph_server;
  bool allow_scene_servers = false;   // whether commands of the scene are started
  std::map<std::string, double> set;  // of the parameters of the scene, by name
  std::vector<std::string> want;      // "position=1e-3": required error of the cheapest setting
};

// Returns the exit status: 0; 1 where no setting has the required errors, and where a run has died or failed.
// Throws Error{interrupted} after Ctrl-C or SIGTERM, when its runs have ended after their windows.
int study(const StudyOptions& options);

}  // namespace tandem::launch
