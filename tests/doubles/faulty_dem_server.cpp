// A dem_server that returns only a part of the loads on walls, or reports false values (fault.hpp), for tests
// of the coordinator's checks.
#include <algorithm>
#include <cmath>
#include <map>

#include "dem_server/coupling/make_solver.hpp"
#include "protocol/participant/main.hpp"
#include "tests/doubles/fault.hpp"

namespace {

using namespace tandem;
using namespace tandem::protocol;

double number(const char* key) {
  return test::fault().value(key, 0.0);
}

class HidesForces final : public LoadSolver {
 public:
  Configured configure(const Configuration& configuration) override {
    return solver_->configure(configuration);
  }
  void save() override { solver_->save(); }
  void restore() override { solver_->restore(); }
  Report report() override { return test::with_fault(solver_->report()); }
  const ParticlesFrame& observe() override {
    frame_ = solver_->observe();
    if (frame_.time == Nanoseconds{}) {
      frame_.position.at(2) += number("start");
      return frame_;
    }
    for (float& velocity : frame_.velocity) velocity *= static_cast<float>(1 - number("slower"));
    if (number("exchanged") > 0) {  // ids
      std::ranges::rotate(frame_.position, frame_.position.begin() + 3);
      std::ranges::rotate(frame_.velocity, frame_.velocity.begin() + 3);
    }
    for (int left_out = 0; left_out < number("left_out"); ++left_out) {
      frame_.id.pop_back();
      frame_.radius.pop_back();
      for (auto* values : {&frame_.velocity, &frame_.spin}) values->resize(3 * frame_.id.size());
      frame_.position.resize(3 * frame_.id.size());
    }
    return frame_;
  }
  const LoadSet& advance(const MotionSet& motion) override {
    if (motion.window.index == fails_) throw Error(ErrorCode::numerics, "a planned failure", "faulty server");
    loads_ = solver_->advance(motion);
    for (BodyLoad& load : loads_.bodies) {
      const Vec3d given = load.mean.force;
      load.mean.force = (1 - share_ - late_) * given + late_ * last_[load.body];
      last_[load.body] = given;
      if (load.body != ground.value) load.mean.torque = (1 - number("torques")) * load.mean.torque;
    }
    ParticleAccount& account = loads_.account;
    account.gravity_impulse = (1 + number("gravity")) * account.gravity_impulse;
    account.kinetic_energy -= number("energy");
    account.lost_particles += static_cast<std::uint64_t>(number("lost"));
    if (const double coarse = number("coarse"); coarse > 0) {
      account.micro_steps = static_cast<std::uint64_t>(
          std::max(1.0, std::floor(static_cast<double>(account.micro_steps) / coarse)));
      account.micro_step = motion.window.length() / static_cast<double>(account.micro_steps);
    }
    if (number("on_ground") != 0) put_on_ground(motion);
    if (motion.window.index == spoiled_ && !loads_.bodies.empty()) loads_.bodies[0].end.torque.y += 0.125;
    return loads_;
  }

 private:
  // Gives the ground the loads of all bodies, about the world's origin.
  void put_on_ground(const MotionSet& motion) {
    BodyLoad sum;
    sum.body = ground.value;
    for (const BodyLoad& load : loads_.bodies) {
      Vec3d arm;
      for (const BodyMotion& body : motion.bodies)
        if (body.body == load.body) arm = 0.5 * (body.begin_pose.p_WB + body.end_pose.p_WB);
      for (auto of : {&BodyLoad::mean, &BodyLoad::end, &BodyLoad::first_moment}) {
        (sum.*of).force += (load.*of).force;
        (sum.*of).torque += (load.*of).torque + cross(arm, (load.*of).force);
      }
    }
    loads_.bodies = {sum};
  }

  std::unique_ptr<LoadSolver> solver_ = dem::make_solver();
  LoadSet loads_;
  ParticlesFrame frame_;
  std::map<std::uint32_t, Vec3d> last_;  // force of the last window, by body
  double share_ = test::fault().value("share", 0.0), late_ = test::fault().value("late", 0.0);
  std::uint64_t spoiled_ = test::fault().value("spoil", ~std::uint64_t{0});
  std::uint64_t fails_ = test::fault().value("fails", ~std::uint64_t{0});
};

}  // namespace

int main(int argc, char** argv) {
  return participant_main(
      argc, argv, own_program("dem_server"),
      std::function<std::unique_ptr<LoadSolver>()>([] { return std::make_unique<HidesForces>(); }));
}
