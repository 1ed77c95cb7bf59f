// The start of a run, up to its first window: what `run` and a dry run have in common.
#pragma once

#include <functional>
#include <string>

#include "launch/coordinator/participants.hpp"
#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// Registers the solvers and gives them the scene. `take_facts` gets the JSON object that each of them sends.
// `besides` are capability bits that the run needs beyond those of the scene. A solver that refuses the scene
// throws its Error here.
void configure(const Solvers& solvers, const SceneFile& file, const RunOptions& options,
               std::uint64_t besides,
               const std::function<void(protocol::Role, const std::string&)>& take_facts);

// `error` with the phase in which it happened, such as "while the servers started", and with how a server of
// ours died where one did. `participants` may be null.
Error explained(const Error& error, const std::string& phase, Participants* participants);

}  // namespace tandem::launch
