#include "launch/coordinator/dry_run.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "common/log.hpp"
#include "common/utf8.hpp"
#include "launch/coordinator/coupler.hpp"
#include "launch/coordinator/facts.hpp"
#include "launch/coordinator/server_command.hpp"
#include "launch/coordinator/start.hpp"
#include "protocol/fd.hpp"

namespace tandem::launch {

using protocol::Role;

DryRun dry_run(const SceneFile& file, const RunOptions& options) {
  DryRun result;
  log::quiet();
  const ForeignServers foreign = foreign_servers(file, options);
  // What the servers log, for the last words of one that dies.
  const protocol::Fd log_file(memfd_create("run.log", MFD_CLOEXEC));
  const std::string log = log_file ? fmt::format("/proc/{}/fd/{}", getpid(), log_file.get()) : "/dev/null";
  std::unique_ptr<Participants> participants;
  try {
    participants = std::make_unique<Participants>(options, file.scene, foreign, log, nullptr);
    const Solvers solvers = participants->solvers();
    const auto take_hello = [&](Role role, const protocol::Hello& hello) {
      (role == Role::mbd ? result.mbd_program : result.dem_program) = printable(shortened(hello.program));
    };
    configure(solvers, file, options, {}, take_hello, [&](Role role, const std::string& facts) {
      const nlohmann::json sent = parse_facts(role, facts);
      for (const auto& warning : sent.value("warnings", nlohmann::json::array()))
        result.warnings.push_back(warning.get<std::string>());
      (role == Role::mbd ? result.mbd : result.dem) = sent;
    });
    Coupler(file.scene, solvers);
  } catch (const Error& error) {
    const Error with_phase = explained(error, "while the servers started", participants.get());
    if (participants) participants->fail(with_phase);
    throw with_phase;
  }
  return result;
}

}  // namespace tandem::launch
