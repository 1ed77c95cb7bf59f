#include "launch/coordinator/start.hpp"

#include <fmt/format.h>

#include <optional>

#include "common/log.hpp"

namespace tandem::launch {

using namespace std::chrono_literals;
using protocol::Role;

void configure(const Solvers& solvers, const SceneFile& file, const RunOptions& options,
               std::uint64_t besides, const std::function<void(Role, const std::string&)>& take_facts) {
  const protocol::Configuration configuration{file.text,  file.origin,     file.meshes,
                                              file.files, options.backend, options.threads};
  const auto register_and_configure = [&](protocol::Remote& solver, Role role, std::uint64_t needed) {
    const protocol::Hello hello = solver.register_peer(needed | besides, options.patience);
    log::info("{} registered: {} on {}", solver.peer(), hello.program, hello.host);
    take_facts(role, solver.configure(configuration).facts);
  };
  if (solvers.mbd) register_and_configure(*solvers.mbd, Role::mbd, needed_of_mbd(file.scene));
  if (solvers.dem) register_and_configure(*solvers.dem, Role::dem, needed_of_dem(file.scene));
}

Error explained(const Error& error, const std::string& phase, Participants* participants) {
  const bool of_the_peer = error.code() == ErrorCode::peer_lost || error.code() == ErrorCode::timeout;
  if (!of_the_peer) return Error(error.code(), error.problem() + " " + phase, error.where(), error.hint());
  // The channel may detect the end earlier than the kernel reports it.
  const auto death = participants ? participants->death(300ms) : std::nullopt;
  if (!death) return error;  // the protocol's error names peer, window and the awaited message
  return Error(ErrorCode::peer_lost, fmt::format("{} {}", *death, phase), {},
               "first seen: " + error.problem());
}

}  // namespace tandem::launch
