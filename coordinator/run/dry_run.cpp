#include "coordinator/run/dry_run.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "common/log.hpp"
#include "common/utf8.hpp"
#include "coordinator/start/server_command.hpp"
#include "coordinator/start/start.hpp"
#include "coordinator/window/coupler.hpp"
#include "protocol/fd.hpp"

namespace tandem::launch {

using protocol::Role;

std::vector<std::string> DryRun::warnings() const {
  std::vector<std::string> all = facts.mbd.warnings.value_or(std::vector<std::string>{});
  for (const auto& more : {facts.dem.warnings, facts.sph.warnings})
    if (more) all.insert(all.end(), more->begin(), more->end());
  if (facts.mbd.locked.value_or(0) > 0)
    all.emplace_back(
        "the loops leave the machine no degree of freedom, so that nothing moves, and a run is suspect: "
        "check "
        "lengths and axes of its loops and leave out a joint that it does not need");
  return all;
}

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
      std::string& program = role == Role::mbd   ? result.mbd_program
                             : role == Role::dem ? result.dem_program
                                                 : result.sph_program;
      program = printable(shortened(hello.program));
    };
    configure(solvers, file, options, {}, take_hello, [&](Role role, const std::string& facts) {
      protocol::decode_facts(role, facts, result.facts);
    });
    Coupler(file.scene, solvers);
  } catch (const Error& error) {
    const Error with_phase = explained(error, at_start, participants.get());
    if (participants) participants->fail(with_phase);
    throw with_phase;
  }
  return result;
}

}  // namespace tandem::launch
