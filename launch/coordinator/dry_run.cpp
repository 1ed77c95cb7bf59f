#include "launch/coordinator/dry_run.hpp"

#include "common/log.hpp"
#include "launch/coordinator/coupler.hpp"
#include "launch/coordinator/facts.hpp"
#include "launch/coordinator/start.hpp"

namespace tandem::launch {

using protocol::Role;

DryRun dry_run(const SceneFile& file, const RunOptions& options) {
  DryRun result;
  log::quiet();
  std::unique_ptr<Participants> participants;
  try {
    // The facts and errors of the solvers contain what they log.
    participants = std::make_unique<Participants>(options, file.scene, "/dev/null", nullptr);
    const Solvers solvers = participants->solvers();
    configure(solvers, file, options, 0, [&](Role role, const std::string& facts) {
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
