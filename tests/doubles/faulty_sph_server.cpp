// An sph_server that returns only a part of the loads on walls, or reports false values (fault.hpp), for
// tests of the coordinator's checks.
#include "protocol/participant/main.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "tests/doubles/fault.hpp"

namespace {

using namespace tandem;
using namespace tandem::protocol;

class FaultyLiquid final : public LoadSolver {
 public:
  Role role() const override { return Role::sph; }
  std::uint64_t capabilities() const override { return LoadSolver::capabilities() | can_observe_liquid; }
  Configured configure(const Configuration& configuration) override {
    return solver_->configure(configuration);
  }
  void save() override { solver_->save(); }
  void restore() override { solver_->restore(); }
  const ParticlesFrame& observe() override { return solver_->observe(); }
  const LoadSet& advance(const MotionSet& motion) override {
    loads_ = solver_->advance(motion);
    for (BodyLoad& load : loads_.bodies)
      load.mean.force = (1 - test::fault().value("share", 0.0)) * load.mean.force;
    return loads_;
  }
  Report report() override {
    Report report = test::with_fault(solver_->report());
    auto facts = nlohmann::ordered_json::parse(report.facts);
    facts["passed_walls"] = test::fault().value("passed", std::uint64_t{0});
    facts["energy_residual_J"] =
        test::fault().value("energy_share", 0.0) * facts["energy_scale_J"].get<double>();
    report.facts = facts.dump();
    return report;
  }

 private:
  std::unique_ptr<LoadSolver> solver_ = sph::make_solver();
  LoadSet loads_;
};

}  // namespace

int main(int argc, char** argv) {
  return participant_main(
      argc, argv, own_program("sph_server"),
      std::function<std::unique_ptr<LoadSolver>()>([] { return std::make_unique<FaultyLiquid>(); }));
}
