// The start of a run up to its first window, for `run` and for a dry run.
#pragma once

#include <functional>
#include <string>

#include "coordinator/scene/scene_file.hpp"
#include "coordinator/start/needs.hpp"
#include "coordinator/start/participants.hpp"

namespace tandem::launch {

// What the solvers answer to their configuration.
struct StartOfSolvers {
  std::vector<protocol::BodyMotion> boundary;  // bodies with walls
  std::vector<double> sensors;                 // of the particles
};

// Registers the solvers and sends them the scene. `take_hello` gets what each of them says of itself, then
// `take_facts` the JSON object that it returns. `besides` is needed of every solver in addition to what the
// scene needs. Throws UnmetNeed where a solver lacks a capability, Error{protocol} where a body starts
// elsewhere, and the Error of a solver that refuses the scene.
StartOfSolvers configure(const Solvers& solvers, const SceneFile& file, const RunOptions& options,
                         const std::vector<Need>& besides,
                         const std::function<void(protocol::Role, const protocol::Hello&)>& take_hello,
                         const std::function<void(protocol::Role, const std::string&)>& take_facts);

inline constexpr const char* at_start = "while the servers started";

// `error` with the phase in which it happened, such as "in window 12 (t = 0.012 s)", and with the ending of a
// server that was started here and died. What is wrong `at_start` is wrong whenever it is read: only an
// ending has that phase. `participants` may be null.
Error explained(const Error& error, const std::string& phase, Participants* participants);

}  // namespace tandem::launch
