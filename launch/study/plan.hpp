// The runs of a study: every combination of the swept settings as a separate scene.
#pragma once

#include <map>

#include "launch/study/study_file.hpp"

namespace tandem::launch {

struct PlannedRun {
  std::vector<Setting> settings;  // one for each sweep
  std::string scene;              // JSON text; its files are named by absolute paths
  std::string
      key;  // hash of scene, files, back end, threads and servers: runs with the same key are the same
  std::string label() const;  // "window=0.001 scheme=dem_first"
};

struct Plan {
  std::vector<PlannedRun> runs;  // the last sweep varies fastest
  std::optional<PlannedRun> reference;
  bool try_explicit_method = false;  // the machine is a tree without limits, and no run sets the method
  std::vector<double> times;  // at which signals are compared, each the end of a window of every run [s]
};

// Every scene has passed the checks of `tandem validate`, and every measured signal exists in it. Frames,
// pictures and checks are removed from the scenes, as they are not measured.
// `servers` are commands of the command line that replace servers; runs with other servers are other runs.
// `set` gives values to parameters of the scene.
Plan make_plan(const Study& study, const std::vector<std::string>& servers = {},
               const std::map<std::string, double>& set = {});

}  // namespace tandem::launch
