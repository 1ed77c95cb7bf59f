#include "tests/doubles/broken_load.hpp"

#include <utility>

#include "dem_server/coupling/make_solver.hpp"

namespace tandem::test {
namespace {

using namespace protocol;

class BrokenLoad final : public LoadSolver {
 public:
  explicit BrokenLoad(LoadFault fault) : fault_(std::move(fault)) {}

  std::uint64_t capabilities() const override { return solver_->capabilities(); }
  Configured configure(const Configuration& configuration) override {
    if (!fault_.scene) return solver_->configure(configuration);
    Configuration changed = configuration;
    fault_.scene(changed.scene_text);
    return solver_->configure(changed);
  }
  const LoadSet& advance(const MotionSet& motion) override {
    MotionSet changed = motion;
    if (fault_.path) fault_.path(changed);
    if (std::exchange(residue_, false))
      for (BodyMotion& body : changed.bodies) body.end_twist.v_WB.z += 1e-6;
    loads_ = solver_->advance(changed);
    if (fault_.load) fault_.load(loads_, motion);
    if (fault_.delays_load) {
      std::vector<BodyLoad> last = std::exchange(last_loads_, loads_.bodies);
      loads_.bodies = std::move(last);
    }
    return loads_;
  }
  void save() override { solver_->save(); }
  void restore() override {
    solver_->restore();
    residue_ = fault_.restores_roughly;
  }
  void checkpoint(const Checkpoint& file) override { solver_->checkpoint(file); }
  void resume(const Checkpoint& file) override {
    solver_->resume(file);
    residue_ = fault_.resumes_roughly;
  }
  const ParticlesFrame& observe() override {
    frame_ = solver_->observe();
    if (fault_.frame) fault_.frame(frame_);
    return frame_;
  }
  void snapshot() override { solver_->snapshot(); }
  const ParticlesFrame& read_snapshot() override {
    snapshot_ = solver_->read_snapshot();
    if (fault_.frame) fault_.frame(snapshot_);
    if (fault_.snapshot) fault_.snapshot(snapshot_);
    return snapshot_;
  }
  const TangentSet& linearise() override {
    tangents_ = solver_->linearise();
    if (fault_.tangents) fault_.tangents(tangents_);
    return tangents_;
  }
  Report report() override { return solver_->report(); }

 private:
  LoadFault fault_;
  std::unique_ptr<LoadSolver> solver_ = dem::make_solver();
  LoadSet loads_;
  ParticlesFrame frame_, snapshot_;
  TangentSet tangents_;
  std::vector<BodyLoad> last_loads_;
  bool residue_ = false;
};

}  // namespace

std::unique_ptr<LoadSolver> broken(const LoadFault& fault) {
  return std::make_unique<BrokenLoad>(fault);
}

}  // namespace tandem::test
