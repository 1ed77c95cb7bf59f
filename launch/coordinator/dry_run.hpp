// The start of a run without the run: solvers are started and given the scene, and leave before the first
// window.
#pragma once

#include <nlohmann/json.hpp>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// What solvers tell of a scene that they have built. A solver that the scene does not need has none.
struct DryRun {
  nlohmann::json mbd = nlohmann::json::object(), dem = nlohmann::json::object();  // facts, as in summary.json
  std::vector<std::string> warnings;                                              // of both
};

// Throws the Error with which `tandem run` would end before its first window. Leaves no folder and no
// process. Of the options, backend, threads and patience count.
DryRun dry_run(const SceneFile& file, const RunOptions& options);

}  // namespace tandem::launch
