#include "mbd_server/coupling/error_estimate.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/unit/mbd_server/workshop.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace {

using Json = nlohmann::json;
using machines::WholeRun;
using machines::with_step;

constexpr const char* hint = "; tandem run --estimate richardson measures it";

void expect_none(WholeRun& run, const std::string& reason) {
  const Json facts = run.facts();
  for (const char* name :
       {"mbd_position_error_estimate_m", "mbd_rotation_error_estimate_rad", "mbd_energy_error_estimate_J"})
    EXPECT_THAT(facts[name].get<std::string>(),
                testing::AllOf(testing::StartsWith("not estimated: " + reason), testing::EndsWith(hint)));
}

TEST(ErrorEstimate, SaysWhyThereIsNone) {
  scene::Scene scene = machines::shipped("simple_pendulum");
  scene.end_time = .2;
  machines::add_wall(scene, BodyId{0});
  WholeRun loaded(scene, 1);
  expect_none(loaded, "loads of particles or a controller act");
  scene.mbd->integrator.extrapolate = true;
  WholeRun extrapolated(scene);
  expect_none(extrapolated, "the error of second order is extrapolated (its two runs differ by ");
  const double finer = extrapolated.facts()["mbd_position_error_estimate"];
  EXPECT_GT(finer, 1e-7);
  EXPECT_LT(finer, 1e-3);
  WholeRun stops(machines::shipped("stops"));
  expect_none(stops, "the error control took ");
  EXPECT_THAT(stops.facts()["mbd_position_error_estimate"].get<std::string>(),
              testing::HasSubstr("steps with local errors of up to 1e-08 each"));
  // A swing of 1e-4 rad under a tolerance of as much.
  scene::Scene small = machines::shipped("simple_pendulum");
  small.gravity = {-9.81, -9.81e-4, 0};
  small.mbd->integrator.step.reset();
  small.mbd->integrator.error_tolerance = 1e-4;
  small.coupling.window = 0.2;
  small.end_time = 10;
  WholeRun coarse(small);
  EXPECT_GT(coarse.facts()["mbd_position_error_estimate"].get<double>(), 0.01);
  scene = machines::shipped("double_pendulum");
  scene.end_time = 60;  // chaotic
  scene.mbd->integrator.step = 1e-3;
  WholeRun chaos(scene);
  const Json facts = chaos.facts();
  // Errors have grown to the size of the motion.
  EXPECT_GT(facts["mbd_position_error_estimate"].get<double>(), 0.05);
  EXPECT_EQ(facts["mbd_energy_error_estimate_J"], std::abs(facts["mbd_energy_balance_J"].get<double>()));
}

// Where there is no estimate, the sum of the local errors distinguishes a step that is too long from a
// chaotic motion.
TEST(ErrorEstimate, LocalErrorsAddUpToTheSizeOfTheError) {
  for (const double factor : {4., 20., 40.}) {
    WholeRun run(with_step("simple_pendulum", factor));
    scene::Scene better = machines::shipped("simple_pendulum");
    better.mbd->integrator.extrapolate = true;
    WholeRun exact(better);
    const Pose is = run.solver.observe().bodies[0].pose, should_be = exact.solver.observe().bodies[0].pose;
    const double error = norm(rotation_vector(is.q_WB * should_be.q_WB.conjugate()));
    const Json facts = run.facts();
    const double sum = facts["mbd_local_error_sum"];
    std::printf("  simple_pendulum, step %.2e s: error %.2e rad, sum of local errors %.2e\n", factor * 2.5e-3,
                error, sum);
    EXPECT_GT(sum, error / 3);
    EXPECT_LT(sum, error * 3);
    EXPECT_TRUE(exact.facts()["mbd_local_error_sum"].is_null());
  }
  scene::Scene scene = machines::shipped("double_pendulum");
  scene.end_time = 20;  // chaotic
  scene.mbd->integrator.step = 1e-3;
  WholeRun chaos(scene);
  const Json facts = chaos.facts();
  EXPECT_GT(facts["mbd_position_error_estimate"].get<double>(), 0.05);
  EXPECT_LT(facts["mbd_local_error_sum"].get<double>(), 1e-3);
}

// A vibration that is shaken and damped, under loads of particles: its local errors, of alternating signs,
// add up to what would mark the run, and the run is repeated under these loads.
TEST(ErrorEstimate, UnderLoadsFromHalfSteps) {
  const auto shaken = [](double step) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {0, 0, 0});
    scene::Joint& joint =
        machines::add_joint(scene, "j", scene::JointType::prismatic, ground, b, {0, 0, 0}, {0, 1, 0});
    joint.damping = 20;
    scene::SpringDamper spring;
    spring.name = "s", spring.body_b = b, spring.point_a = {0, -1, 0}, spring.length = 1,
    spring.stiffness = 2000;
    scene.mbd->forces.push_back(spring);
    scene::BodyLoad load;
    load.name = "f", load.body = b, load.direction = {0, 1, 0};
    load.size = scene::HarmonicMotion{.amplitude = 50, .frequency = 12};
    scene.mbd->forces.push_back(load);
    machines::add_wall(scene, b);
    scene.coupling.window = 1e-3;
    scene.mbd->integrator.step = step;
    scene.end_time = 4;
    return scene;
  };
  WholeRun run(shaken(1e-3), .3), exact(shaken(2.5e-5), .3);
  const Json facts = run.facts();
  const double error = std::abs(run.solver.state().q[0] - exact.solver.state().q[0]),
               reach = 2 * 50 / std::hypot(2000 - 75.4 * 75.4, 20 * 75.4);
  std::printf("  off by %.2e of the motion, stated %.2e, local errors %.2e\n", error / reach,
              facts["mbd_position_error_estimate"].get<double>(), facts["mbd_local_error_sum"].get<double>());
  EXPECT_GT(facts["mbd_local_error_sum"].get<double>(), 0.02);
  EXPECT_GT(facts["mbd_position_error_estimate"].get<double>(), error / reach / 3);
  EXPECT_LT(facts["mbd_position_error_estimate"].get<double>(), 5e-3);
}

// A scheme that iterates goes back to the begin of a window.
TEST(LoadJournal, KeepsTheLastLoadsOfEachWindow) {
  const auto at = [](double value) {
    State state;
    state.q = state.inputs = VectorXd::Constant(2, value);
    state.loads = state.load_rates = Eigen::Matrix<double, 6, Eigen::Dynamic>::Constant(6, 1, 10 * value);
    return state;
  };
  LoadJournal journal(2, at(0));
  for (int n = 0; n < 3; ++n) journal.note({static_cast<std::uint64_t>(n), {n}, {n + 1}}, at(n));
  journal.keep(1);
  journal.note({1, {1}, {3}}, at(7));
  ASSERT_EQ(journal.size(), 2U);
  EXPECT_TRUE(journal.complete());
  EXPECT_EQ(journal.window(1).end.count, 3);
  State state = at(0);
  journal.load(1, state);
  EXPECT_EQ(state.loads, at(7).loads);
  EXPECT_EQ(state.load_rates, at(7).load_rates);
  EXPECT_EQ(journal.inputs(1, state), at(7).inputs);
  EXPECT_EQ(journal.coordinates(0, state), at(0).q);
}

// By half steps: an error c h^2 of a method of second order is exact.
TEST(ErrorEstimate, FromHalfSteps) {
  const auto end = [](double h, double steps) {
    RunEnd run{.bodies = {Pose{}}, .energy = 5 - 3 * h * h, .steps = steps};
    run.bodies[0].p_WB = {1 + 2 * h * h, 0, 0};
    return run;
  };
  const RunEnd run = end(.1, 10);
  const ErrorEstimate halved = estimate_error(run, end(.05, 27), true);
  EXPECT_NEAR(*halved.position, 2e-2, 1e-15);
  EXPECT_NEAR(*halved.energy, 3e-2, 1e-15);
  const ErrorEstimate counted = estimate_error(run, end(1. / 30, 30), false);
  EXPECT_NEAR(*counted.position, 2e-2, 1e-15);
  const ErrorEstimate none = estimate_error(run, end(.1, 12), false);
  EXPECT_FALSE(none.position);
  EXPECT_EQ(
      none.reason,
      "the run with shorter steps took only 1.2 times as many steps, and differs by 0 m and 0 rad at the "
      "end; give mbd.integrator.step");
}

// The report does not change the state.
TEST(ErrorEstimate, LeavesNoTrace) {
  WholeRun run(machines::shipped("bricard"));
  const State before = run.solver.state();
  const Json first = run.facts(), second = run.facts();
  EXPECT_EQ(hash(before), hash(run.solver.state()));
  EXPECT_EQ(first["mbd_steps"], second["mbd_steps"]);
}

}  // namespace
}  // namespace tandem::mbd
