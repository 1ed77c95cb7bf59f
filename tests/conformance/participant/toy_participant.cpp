// The smallest participant: a solver and participant_main. With the scene "slow" it computes for longer than
// any test.
#include <chrono>
#include <thread>

#include "protocol/participant/main.hpp"
#include "toy_solvers.hpp"

namespace {

using namespace tandem::protocol;

class MaybeSlow : public test::ToyMotion {
 public:
  Configured configure(const Configuration& configuration) override {
    slow_ = configuration.scene_text == "slow";
    return ToyMotion::configure(configuration);
  }
  const MotionSet& predict(const tandem::Window& window) override {
    if (slow_) std::this_thread::sleep_for(std::chrono::minutes(1));
    return ToyMotion::predict(window);
  }

 private:
  bool slow_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  return participant_main(
      argc, argv, own_program("mbd_server"),
      std::function<std::unique_ptr<MotionSolver>()>([] { return std::make_unique<MaybeSlow>(); }));
}
