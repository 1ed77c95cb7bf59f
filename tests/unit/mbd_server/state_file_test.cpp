// States on disk: a run that continues from one gives the same bits, and a wrong file is refused.
#include "mbd_server/io/state_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <memory>

#include "common/error.hpp"
#include "mbd_server/step/step_control.hpp"
#include "tests/support/damaged_state.hpp"
#include "tests/unit/mbd_server/workshop.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

class StateFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::string refusal(const Model& model) const {
    try {
      read_state(path_, model);
    } catch (const Error& error) {
      return std::string(name(error.code())) + ": " + error.problem();
    }
    return "read";
  }
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("tandem_state_" + std::to_string(getpid()) + ".h5");
};

StepControlSettings tight() {
  StepControlSettings settings;
  settings.tolerance = 1e-7;
  settings.max_step = .02;
  return settings;
}

struct Controlled {
  machines::Run run{workshop(), 1e-3};
  StepControl control{tight()};
  void advance(double end) {
    while (end - run.state.time > 1e-12) control.step(run.integrator, run.system, run.state, end);
  }
};

// With loops, rejected steps and loads, in a new solver.
TEST_F(StateFile, RunsContinueToTheSameBits) {
  Controlled straight;
  straight.run.state.loads.setConstant(1.5);
  straight.run.integrator.jump(straight.run.system, straight.run.state);
  straight.advance(.3);
  write_state(path_, straight.run.model, straight.run.state);
  straight.advance(.6);
  EXPECT_GT(straight.run.integrator.counters().rejected, 0u);

  Controlled resumed;
  resumed.run.state = read_state(path_, resumed.run.model).state;
  EXPECT_EQ(resumed.run.state.time, .3);
  resumed.advance(.6);
  EXPECT_EQ(hash(resumed.run.state), hash(straight.run.state));
  EXPECT_EQ(resumed.run.state.q, straight.run.state.q);
  EXPECT_EQ(resumed.run.state.lambda, straight.run.state.lambda);
  EXPECT_FALSE(std::filesystem::exists(path_.string() + ".part"));
}

// A far too long step, undone, before each step; a restart from disk in between; and an end beyond a singular
// position, where equations become dependent and independent. A step may leave nothing but the state.
TEST_F(StateFile, RejectedStepsAndRestartsLeaveNoTrace) {
  for (const Constraints form : {Constraints::index2, Constraints::index3}) {
    const auto make = [&] {
      return std::make_unique<machines::Run>(machines::ladder(4), 1e-3, .9, NewtonSettings{1e-10, 20}, form);
    };
    int taken_back = 0, failed = 0;
    const auto disturbed_step = [&](machines::Run& run) {
      for (const double h : {3e-3, 3.}) {
        if (run.integrator.try_step(run.system, run.state, h)) {
          run.integrator.undo(run.state);
          ++taken_back;
        } else {
          ++failed;
        }
      }
      run.advance(1);
    };
    const auto straight = make(), first = make(), second = make();
    straight->advance(750);
    for (int i = 0; i < 710; ++i) disturbed_step(*first);
    write_state(path_, first->model, first->state);
    second->state = read_state(path_, second->model).state;
    for (int i = 0; i < 40; ++i) disturbed_step(*second);

    EXPECT_GT(taken_back, 700);
    EXPECT_GT(failed, 0);
    EXPECT_GT(straight->state.lambda.norm(), 1);
    EXPECT_EQ(second->state.lambda, straight->state.lambda);
    EXPECT_EQ(second->state.q, straight->state.q);
    EXPECT_EQ(hash(second->state), hash(straight->state));
  }
}

// A machine without coordinates, loops and loads has empty fields.
TEST_F(StateFile, HoldsAMachineWithoutFreedoms) {
  scene::Scene scene = machines::empty();
  const BodyId box = machines::add_body(scene, "box", 1, {1, 1, 1}, {0, 0, 0});
  machines::add_joint(scene, "bolt", scene::JointType::fixed, ground, box, {0, 0, 0});
  machines::Run run(scene, 1e-3);
  run.advance(3);
  write_state(path_, run.model, run.state);
  EXPECT_EQ(hash(read_state(path_, run.model).state), hash(run.state));
}

TEST_F(StateFile, RefusesTheStateOfAnotherMachine) {
  machines::Run run(machines::pendulum(), 1e-3);
  write_state(path_, run.model, run.state);
  scene::Scene other = machines::pendulum();
  other.mbd->joints[0].name = "hinge";
  EXPECT_EQ(refusal(build_model(other)),
            "scene: is the state of another machine: it has 'joint \"pin\" of body \"mass\"' where the scene "
            "has 'joint "
            "\"hinge\" of body \"mass\"'");
}

// Wrong values with a correct digest.
TEST_F(StateFile, RefusesDamagedValues) {
  const std::filesystem::path damaged = path_.string() + "_damaged.h5";
  machines::Run run(workshop(), 1e-3);
  run.advance(5);
  RunTotals totals;
  totals.largest_reaction_joint = 0;
  write_state(path_, run.model, run.state, totals);
  int refused = 0;
  constexpr int files = 400;
  for (int seed = 0; seed < files; ++seed) {
    SCOPED_TRACE(test::damage_state(path_, damaged, static_cast<std::uint64_t>(seed)));
    try {
      const SavedState saved = read_state(damaged, run.model);
      EXPECT_TRUE(saved.state.q.allFinite());
      EXPECT_LT(saved.totals.largest_reaction_joint, static_cast<double>(run.model.joints.size()));
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), damaged.string()) << error.what();
      ++refused;
    }
  }
  std::filesystem::remove(damaged);
  std::printf("%d of %d refused\n", refused, files);
  EXPECT_GT(refused, files / 4);

  totals.largest_reaction_joint = 1e6;
  write_state(path_, run.model, run.state, totals);
  EXPECT_EQ(refusal(run.model),
            "resource: its value 'totals/largest_reaction_joint' is damaged: 1e+06 is no number of a joint, "
            "loop or shape of the scene");
}

TEST_F(StateFile, RefusesWhatIsNoState) {
  const Model model = build_model(machines::pendulum());
  EXPECT_EQ(refusal(model), "resource: does not exist");
  std::ofstream(path_) << "no HDF5";
  EXPECT_EQ(refusal(model), "resource: is no state of this version, or is damaged");
  machines::Run run(machines::pendulum(), 1e-3);
  EXPECT_THROW(write_state("/no/such/folder/state.h5", run.model, run.state), Error);
  // Truncated in the middle.
  write_state(path_, run.model, run.state);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  EXPECT_NE(refusal(model), "read");
}

}  // namespace
}  // namespace tandem::mbd
