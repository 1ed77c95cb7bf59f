// The start of a run only: solvers are started, receive the scene, and end before the first window.
#pragma once

#include <nlohmann/json.hpp>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// Facts that the solvers report about a scene they have built. Empty for a solver that the scene does not
// need.
struct DryRun {
  nlohmann::json mbd = nlohmann::json::object(), dem = nlohmann::json::object();  // facts, as in summary.json
  std::string mbd_program, dem_program;  // as the solvers name themselves: "mbd_server 0.1.0"
  std::vector<std::string> warnings;     // of both
};

// Throws the Error with which `tandem run` would end before its first window. Leaves no folder and no
// process. It uses only the options backend, threads and
// patience, and those of the servers.
DryRun dry_run(const SceneFile& file, const RunOptions& options);

}  // namespace tandem::launch
