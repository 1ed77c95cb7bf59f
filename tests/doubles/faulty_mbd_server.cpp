// An mbd_server that applies only a part of the loads of the particles, or reports false values (fault.hpp),
// for tests of the coordinator's checks.
#include <map>

#include "mbd_server/coupling/make_solver.hpp"
#include "protocol/participant/main.hpp"
#include "tests/doubles/fault.hpp"

namespace {

using namespace tandem;
using namespace tandem::protocol;

double number(const char* key) {
  return test::fault().value(key, 0.0);
}

class DropsLoad final : public MotionSolver {
 public:
  std::uint64_t capabilities() const override { return MotionSolver::capabilities() | can_checkpoint; }
  Configured configure(const Configuration& configuration) override {
    Configuration changed = configuration;
    if (number("no_joints") != 0) {
      auto scene = nlohmann::ordered_json::parse(changed.scene_text);
      for (auto& joint : scene["mbd"]["joints"])
        joint = {
            {"name", joint["name"]}, {"type", "free"}, {"child", joint["child"]}, {"position", {0, 0, 0}}};
      changed.scene_text = scene.dump();
    }
    Configured configured = solver_->configure(changed);
    for (BodyMotion& motion : configured.boundary) {
      orientation_[motion.body] = motion.end_pose.q_WB;
      motion.begin_pose.p_WB.z += start_;
      motion.end_pose.p_WB.z += start_;
    }
    return configured;
  }
  void checkpoint(const Checkpoint& file) override { solver_->checkpoint(file); }
  void resume(const Checkpoint& file) override {
    solver_->resume(file);
    resumed_ = number("resume");
  }
  void save() override { solver_->save(); }
  void restore() override { solver_->restore(); }
  Report report() override { return test::with_fault(solver_->report()); }
  const MotionSet& predict(const Window& window) override { return solver_->predict(window); }
  const TangentSet& linearise() override { return solver_->linearise(); }
  const BodiesFrame& observe() override {
    frame_ = solver_->observe();
    for (BodyState& state : frame_.bodies)
      state.pose.p_WB.z += resumed_ + (frame_.time > Nanoseconds{} ? number("frame") : number("start"));
    for (BodyState& state : frame_.bodies) {
      if (const auto found = strayed_.find(state.body); found != strayed_.end())
        state.pose.p_WB += found->second;
      if (const auto found = orientation_.find(state.body); found != orientation_.end() && frozen_)
        state.pose.q_WB = found->second;
    }
    if (frame_.time > Nanoseconds{}) frame_.energy += number("energy");
    return frame_;
  }
  const MotionSet& advance(const LoadSet& loads) override {
    loads_ = loads;
    for (BodyLoad& load : loads_.bodies) {
      load.mean.force = (1 - share_ - forces_) * load.mean.force;
      load.mean.torque = (1 - share_ - torques_) * load.mean.torque;
    }
    motion_ = solver_->advance(loads_);
    if (torques_ != 0)
      for (BodyMotion& motion : motion_.bodies)
        motion.applied_impulse.torque = (1 / (1 - torques_)) * motion.applied_impulse.torque;
    for (BodyMotion& motion : motion_.bodies) {
      motion.applied_impulse.force = (1 / (1 - forces_)) * motion.applied_impulse.force;
      motion.begin_pose.p_WB.z += resumed_ + number("jump");
      motion.end_pose.p_WB.z += resumed_;
    }
    for (BodyMotion& motion : motion_.bodies) {
      Vec3d& strayed = strayed_[motion.body];
      const Vec3d before = strayed;
      strayed += number("stray") * (motion.end_pose.p_WB - motion.begin_pose.p_WB);
      motion.begin_pose.p_WB += before;
      motion.end_pose.p_WB += strayed;
      if (frozen_) motion.begin_pose.q_WB = motion.end_pose.q_WB = orientation_[motion.body];
    }
    if (loads.window.index == spoiled_) motion_.bodies[0].end_twist.v_WB.z += 0.125;
    return motion_;
  }

 private:
  std::unique_ptr<MotionSolver> solver_ = mbd::make_solver();
  LoadSet loads_;
  MotionSet motion_;
  BodiesFrame frame_;
  std::map<std::uint32_t, Vec3d> strayed_;     // by body [m]
  std::map<std::uint32_t, Quat> orientation_;  // at the start
  const bool frozen_ = number("frozen") != 0;
  double resumed_ = 0;  // [m]
  double start_ = number("start"), forces_ = number("forces");
  double share_ = test::fault().value("share", 0.0), torques_ = test::fault().value("torques", 0.0);
  std::uint64_t spoiled_ = test::fault().value("spoil", ~std::uint64_t{0});
};

}  // namespace

int main(int argc, char** argv) {
  const int status = participant_main(
      argc, argv, own_program("mbd_server"),
      std::function<std::unique_ptr<MotionSolver>()>([] { return std::make_unique<DropsLoad>(); }));
  return status == 0 ? static_cast<int>(number("status")) : status;
}
