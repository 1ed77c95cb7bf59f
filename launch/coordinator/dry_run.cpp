#include "launch/coordinator/dry_run.hpp"

#include <nlohmann/json.hpp>

#include "common/log.hpp"
#include "launch/coordinator/coupler.hpp"
#include "launch/coordinator/start.hpp"

namespace tandem::launch {

using protocol::Role;

std::vector<std::string> DryRun::warnings() const {
  std::vector<std::string> all = facts.mbd.warnings.value_or(std::vector<std::string>{});
  if (facts.dem.warnings) all.insert(all.end(), facts.dem.warnings->begin(), facts.dem.warnings->end());
  return all;
}

DryRun dry_run(const SceneFile& file, const RunOptions& options) {
  DryRun result;
  log::quiet();
  std::unique_ptr<Participants> participants;
  try {
    // The facts and errors of the solvers contain what they log.
    participants = std::make_unique<Participants>(options, file.scene, "/dev/null", nullptr);
    const Solvers solvers = participants->solvers();
    configure(solvers, file, options, 0, [&](Role role, const std::string& facts) {
      protocol::decode_facts(role, facts, result.facts);
      protocol::expect_required_facts(role, result.facts);
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
