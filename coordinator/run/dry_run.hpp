// The start of a run only: solvers are started, receive the scene, and end before the first window.
#pragma once

#include "coordinator/scene/scene_file.hpp"
#include "protocol/facts.hpp"

namespace tandem::launch {

// What the solvers report about a scene they have built. A solver that the scene does not need reports
// nothing.
struct DryRun {
  protocol::SolverFacts facts;
  std::string mbd_program, dem_program, sph_program;  // as the solvers name themselves: "mbd_server 0.1.0"
  std::vector<std::string> warnings() const;          // of all
};

// Throws the Error with which `tandem run` would end before its first window. Leaves no folder and no
// process. It uses only the options backend, threads and
// patience, and those of the servers.
DryRun dry_run(const SceneFile& file, const RunOptions& options);

}  // namespace tandem::launch
