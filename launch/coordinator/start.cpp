#include "launch/coordinator/start.hpp"

#include <fmt/format.h>

#include <optional>

#include "common/log.hpp"
#include "launch/coordinator/start_state.hpp"

namespace tandem::launch {

using namespace std::chrono_literals;
using protocol::Role;

StartOfSolvers configure(const Solvers& solvers, const SceneFile& file, const RunOptions& options,
                         const std::vector<Need>& besides,
                         const std::function<void(Role, const protocol::Hello&)>& take_hello,
                         const std::function<void(Role, const std::string&)>& take_facts) {
  // All are registered first: which schemes are possible depends on all of them.
  std::vector<Offer> offers;
  const auto enrol = [&](protocol::Remote* solver, Role role) {
    if (!solver) return;
    const protocol::Hello hello = solver->register_peer(0, options.patience);
    log::info("{} registered: {} on {}", solver->peer(), hello.program, hello.host);
    offers.push_back({role, hello.program, hello.capabilities});
    take_hello(role, hello);
  };
  enrol(solvers.mbd, Role::mbd);
  for (protocol::Remote* solver : solvers.loads) enrol(solver, solver->role());
  expect_capabilities(file.scene, besides, offers);

  const protocol::Configuration configuration{file.text,  file.origin,     file.meshes,
                                              file.files, options.backend, options.threads};
  StartOfSolvers start;
  if (solvers.mbd) {
    const protocol::Configured configured = solvers.mbd->configure(configuration);
    take_facts(Role::mbd, configured.facts);
    StartOfBodies(file.scene).expect(configured.boundary);
    start.boundary = configured.boundary;
  }
  for (protocol::Remote* solver : solvers.loads) {
    const protocol::Configured configured = solver->configure(configuration);
    take_facts(solver->role(), configured.facts);
    start.sensors.insert(start.sensors.end(), configured.sensors.begin(), configured.sensors.end());
  }
  return start;
}

Error explained(const Error& error, const std::string& phase, Participants* participants) {
  if (dynamic_cast<const UnmetNeed*>(&error)) return error;  // its sentence is about scene and solvers
  const bool of_the_peer = error.code() == ErrorCode::peer_lost || error.code() == ErrorCode::timeout;
  if (!of_the_peer)
    return phase == at_start
               ? error
               : Error(error.code(), error.problem() + " " + phase, error.where(), error.hint());
  // The channel may detect the end earlier than the kernel reports it.
  const auto death = participants ? participants->death(300ms) : std::nullopt;
  if (!death) return error;  // the protocol's error names peer, window and the awaited message
  return Error(ErrorCode::peer_lost, fmt::format("{} {}", death->sentence, phase), {},
               death->last_words.empty() ? "first seen: " + error.problem()
                                         : "its last line in run.log: " + death->last_words);
}

}  // namespace tandem::launch
