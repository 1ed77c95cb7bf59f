// dem_server on several ranks: what starts it, and what it does not serve yet.
#pragma once

#include <string>
#include <vector>

#include "coordinator/scene/options.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/start/processes.hpp"
#include "coordinator/start/server_command.hpp"

namespace tandem::launch {

// Throws Error{usage} where the ranks of `options` cannot compute any run, and says what to write instead.
void expect_ranks(const RunOptions& options);
// The same where they cannot compute this one.
void expect_ranks(const RunOptions& options, const scene::Scene& scene, const ForeignServers& foreign);

// Starts the ranks by mpirun; rank 0, which is on this host, gets the arguments of a server.
Command start_of_ranks(const RunOptions& options, const std::vector<std::string>& arguments);

}  // namespace tandem::launch
