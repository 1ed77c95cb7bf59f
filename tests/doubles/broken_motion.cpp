#include "tests/doubles/broken_motion.hpp"

#include <utility>
#include <vector>

#include "mbd_server/coupling/make_solver.hpp"

namespace tandem::test {
namespace {

using namespace protocol;

class BrokenMotion final : public MotionSolver {
 public:
  explicit BrokenMotion(MotionFault fault) : fault_(std::move(fault)) {}

  std::uint64_t capabilities() const override { return solver_->capabilities(); }
  Configured configure(const Configuration& configuration) override {
    Configuration changed = configuration;
    if (fault_.scene) fault_.scene(changed);
    Configured configured = solver_->configure(changed);
    if (fault_.configured) fault_.configured(configured);
    return configured;
  }
  const MotionSet& predict(const Window& window) override {
    if (fault_.predicts_by_advancing) {
      motion_ = solver_->extrapolate(window);
    } else {
      motion_ = solver_->predict(window);
    }
    if (fault_.predicted) fault_.predicted(motion_);
    leave_residue(Residue::predict);
    return motion_;
  }
  const MotionSet& extrapolate(const Window& window) override {
    motion_ = solver_->extrapolate(window);
    if (fault_.extrapolated) fault_.extrapolated(motion_);
    leave_residue(Residue::extrapolate);
    return motion_;
  }
  const MotionSet& advance(const LoadSet& loads) override {
    LoadSet changed = loads;
    if (fault_.delays_load) changed.bodies = std::exchange(last_loads_, loads.bodies);
    if (fault_.load) fault_.load(changed);
    if (std::exchange(residue_, false))
      for (BodyLoad& load : changed.bodies) load.mean.force = 1.000001 * load.mean.force;
    motion_ = solver_->advance(changed);
    if (fault_.motion) fault_.motion(motion_, loads);
    return motion_;
  }
  void control(const ControlSet& inputs) override {
    inputs_ = inputs;
    solver_->control(inputs);
  }
  void save() override {
    solver_->save();
    restored_ = false;
  }
  void restore() override {
    solver_->restore();
    leave_residue(Residue::restore);
    if (std::exchange(restored_, true)) leave_residue(Residue::second_restore);
    if (fault_.keeps_control_in_restore && !inputs_.values.empty()) solver_->control(inputs_);
  }
  void checkpoint(const Checkpoint& file) override { solver_->checkpoint(file); }
  void resume(const Checkpoint& file) override {
    solver_->resume(file);
    leave_residue(Residue::resume);
  }
  const BodiesFrame& observe() override {
    frame_ = solver_->observe();
    if (fault_.frame) fault_.frame(frame_);
    return frame_;
  }
  const TangentSet& linearise() override { return solver_->linearise(); }
  Report report() override { return solver_->report(); }

 private:
  void leave_residue(Residue after) { residue_ = residue_ || fault_.residue == after; }

  MotionFault fault_;
  std::unique_ptr<MotionSolver> solver_ = mbd::make_solver();
  MotionSet motion_;
  BodiesFrame frame_;
  ControlSet inputs_;
  std::vector<BodyLoad> last_loads_;
  bool restored_ = false, residue_ = false;
};

}  // namespace

std::unique_ptr<MotionSolver> broken(const MotionFault& fault) {
  return std::make_unique<BrokenMotion>(fault);
}

}  // namespace tandem::test
