// The explicit method: accelerations without a matrix, the estimate of its error, restored runs, and machines
// for which it is refused.
#include "mbd_server/step/dormand_prince.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "mbd_server/step/step_control.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace {

using scene::IntegrationMethod;

struct Explicit {
  machines::Run run;
  DormandPrince method;
  StepControl control;

  explicit Explicit(const scene::Scene& scene, const StepControlSettings& settings = {})
      : run(scene, 1e-3), method(run.system, run.state), control(settings) {
    method.start(run.system, run.state, settings.max_step);
  }
  void advance(double end) {
    while (end - run.state.time > 1e-12) control.step(method, run.system, run.state, end);
  }
};

scene::Scene with_method(scene::Scene scene, double tolerance = 1e-8) {
  scene.mbd->integrator.method = IntegrationMethod::dormand_prince;
  scene.mbd->integrator.error_tolerance = tolerance;
  return scene;
}

// The menagerie with loads, in motion.
State loaded(machines::Run& run) {
  run.advance(30);
  State state = run.state;
  state.loads.setRandom();
  state.load_rates.setRandom();
  state.load_time = state.time - .1;
  return state;
}

TEST(Acceleration, SolvesTheEquationOfMotion) {
  for (const scene::Scene& scene : {machines::menagerie(), machines::heavy_top(), machines::chain(20),
                                    machines::free_body(2, {.1, .2, .25}, {1, 2, 3})}) {
    machines::Run run(scene, 1e-3);
    State state = loaded(run);
    state.udot.setZero();
    const double scale = run.system.residual(state).lpNorm<Eigen::Infinity>();
    const VectorXd from_zero = run.system.acceleration(state);
    state.udot = from_zero;
    EXPECT_LT(run.system.residual(state).lpNorm<Eigen::Infinity>(), 1e-12 * scale);
    // The accelerations of the state do not matter.
    state.udot.setConstant(10);
    EXPECT_LT((run.system.acceleration(state) - from_zero).lpNorm<Eigen::Infinity>(),
              1e-10 * from_zero.lpNorm<Eigen::Infinity>());
  }
}

TEST(Acceleration, NamesTheCoordinateWithoutInertia) {
  machines::Run run(machines::pendulum(), 1e-3);
  Model model = run.model;
  model.links[1].mass = 0;
  MachineSystem system(model);
  try {
    system.acceleration(run.state);
    FAIL() << "a coordinate without inertia has no acceleration";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_NE(std::string(error.what()).find("pin"), std::string::npos) << error.what();
  }
}

TEST(DormandPrince, EstimatesBecomeTheLocalErrorsOfOrderFour) {
  // The embedded method of order 4 would make the estimated error; the step itself is more accurate.
  double last = 0;
  for (const double h : {.2, .1, .05}) {
    Explicit coarse(machines::pendulum()), fine(machines::pendulum());
    for (Explicit* e : {&coarse, &fine}) {
      e->run.state.q[0] = .7, e->run.state.u[0] = 2.5;
      e->method.start(e->run.system, e->run.state, h);
    }
    const std::optional<LocalError> estimate = coarse.method.try_step(coarse.run.system, coarse.run.state, h);
    ASSERT_TRUE(estimate);
    for (int i = 0; i < 100; ++i) fine.method.step(fine.run.system, fine.run.state, h / 100);
    EXPECT_LT(std::abs(coarse.run.state.q[0] - fine.run.state.q[0]), estimate->position);
    EXPECT_LT(std::abs(coarse.run.state.u[0] - fine.run.state.u[0]), estimate->velocity);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / estimate->position), 5, .4);
    }
    last = estimate->position;
  }
}

TEST(DormandPrince, UndoneStepLeavesNoTrace) {
  Explicit e(machines::menagerie());
  const State before = e.run.state;
  ASSERT_TRUE(e.method.try_step(e.run.system, e.run.state, 1e-3));
  EXPECT_NE(hash(e.run.state), hash(before));
  e.method.undo(e.run.state);
  EXPECT_EQ(hash(e.run.state), hash(before));
}

// A step in which a ball joint would turn by more than half a turn is impossible, and the control takes a
// shorter one. A sphere spins with a constant rate, so that no error would reject the step.
TEST(DormandPrince, TurnsBallJointsByLessThanHalfATurn) {
  scene::Scene scene = machines::free_body(1, {.1, .1, .1}, {0, 0, 0});
  scene.mbd->bodies[0].twist.w_WB = {0, 0, 10};
  Explicit e(scene, {.tolerance = 1e-8, .max_step = 1});
  const State before = e.run.state;
  EXPECT_FALSE(e.method.try_step(e.run.system, e.run.state, 1));
  EXPECT_EQ(hash(e.run.state), hash(before));
  e.advance(1);
  const Quaterniond q(e.run.state.q[3], e.run.state.q[4], e.run.state.q[5], e.run.state.q[6]);
  EXPECT_NEAR(std::abs(q.dot(Quaterniond(std::cos(5.), 0, 0, std::sin(5.)))), 1, 1e-14);
}

TEST(DormandPrince, RestoredRunsContinueToTheSameBits) {
  const StepControlSettings settings{.tolerance = 1e-7, .max_step = .1};
  Explicit whole(machines::menagerie(), settings);
  whole.advance(.2);
  const State saved = whole.run.state;
  whole.advance(.5);
  Explicit other(machines::menagerie(), settings);
  other.run.state = saved;
  other.advance(.5);
  EXPECT_EQ(hash(other.run.state), hash(whole.run.state));
}

// Loads that are linear in time, drives, motions, springs: the same as by the implicit method.
TEST(DormandPrince, AgreesWithGeneralizedAlphaOnTheMenagerie) {
  scene::Scene scene = machines::menagerie();
  scene.coupling.window = .05, scene.end_time = .3;
  scene.mbd->integrator.error_tolerance = 1e-11;
  machines::WholeRun implicit(scene, 2);
  machines::WholeRun explicit_run(with_method(scene, 1e-10), 2);
  const VectorXd difference = implicit.solver.state().u - explicit_run.solver.state().u;
  EXPECT_LT(difference.lpNorm<Eigen::Infinity>(), 2e-6);
  EXPECT_LT((implicit.solver.state().q - explicit_run.solver.state().q).lpNorm<Eigen::Infinity>(), 2e-7);
  const nlohmann::json facts = explicit_run.facts();
  EXPECT_GT(facts["mbd_evaluations"], 6 * facts["mbd_steps"].get<int>());
  EXPECT_EQ(facts["mbd_newton_iterations"], 0);
  EXPECT_LT(std::abs(facts["mbd_energy_balance_J"].get<double>()),
            1e-5 * facts["mbd_energy_scale_J"].get<double>());
}

TEST(DormandPrince, IsRefusedForClosedLoops) {
  try {
    machines::WholeRun run(with_method(machines::ladder(2)));
    FAIL() << "a loop was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_EQ(error.where(), "mbd.integrator.method");
    EXPECT_NE(std::string(error.what()).find("2 are closed by"), std::string::npos) << error.what();
  }
}

// A bushing of 1e14 N/m under a mass of 1 kg: 1e7 rad/s in windows of 0.1 s.
TEST(DormandPrince, IsRefusedWhereStepsCollapse) {
  scene::Scene scene = machines::free_body(1, {.1, .1, .1}, {0, 0, -9.81});
  scene::Bushing bushing;
  bushing.name = "mount";
  bushing.body_b = BodyId{0};
  for (std::size_t k = 0; k < 6; ++k) bushing.stiffness[7 * k] = 1e14;
  scene.mbd->forces.push_back(bushing);
  scene.coupling.window = .1, scene.end_time = .1;
  try {
    machines::WholeRun run(with_method(scene));
    FAIL() << "steps of 1e-7 s were taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_NE(error.hint().find("generalized_alpha"), std::string::npos) << error.hint();
  }
}

// An overdamped slider: 1e4 per second. Steps are limited by stability, and the run says so.
TEST(DormandPrince, WarnsWhereStabilityLimitsTheSteps) {
  scene::Scene scene = machines::bead(1, 1);
  scene.mbd->joints[0].damping = 1e4;
  scene.coupling.window = .1, scene.end_time = .3;
  machines::WholeRun run(with_method(scene, 1e-6));
  const nlohmann::json facts = run.facts();
  EXPECT_GT(facts["mbd_stiff_steps"], facts["mbd_steps"].get<int>() / 2);
  ASSERT_EQ(facts["warnings"].size(), 1u) << facts.dump(1);
  EXPECT_NE(facts["warnings"][0].get<std::string>().find("stability"), std::string::npos);
}

}  // namespace
}  // namespace tandem::mbd
