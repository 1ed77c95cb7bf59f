// The integrator: its constants, start, jumps and errors; a step does not allocate.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "common/error.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "mbd_server/step/step_control.hpp"
#include "tests/unit/mbd_server/workshop.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

// Eigen allocates with malloc, the standard library with operator new, which calls malloc: glibc allows both
// to be counted in one place. Sanitizers have their own malloc and must not be mixed with another one:
// nothing is counted there.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNT_ALLOCATIONS 1
namespace {
std::size_t allocations = 0;
}
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace tandem::mbd {
namespace {

TEST(GeneralizedAlpha, ConstantsAreThoseOfChungAndHulbert) {
  for (const double rho : {0.0, .3, .8, 1.0}) {
    const GeneralizedAlphaConstants c(rho);
    EXPECT_NEAR(c.gamma, 0.5 - c.alpha_m + c.alpha_f, 1e-15);                   // second order
    EXPECT_NEAR(c.beta, 0.25 * std::pow(1 - c.alpha_m + c.alpha_f, 2), 1e-15);  // largest dissipation
    EXPECT_NEAR((c.alpha_f - c.alpha_m - 1) / (c.alpha_f - c.alpha_m + 1), -rho, 1e-15);  // rho_inf
  }
}

TEST(GeneralizedAlpha, StartsConsistently) {
  // Pendulum from the horizontal: q'' = g/l.
  machines::Run run(machines::pendulum(), 1e-3);
  EXPECT_NEAR(run.state.udot[0], 9.81, 1e-14);
  EXPECT_LT(run.system.residual(run.state).norm(), 1e-12);
}

// a stands for u' at (alpha_m - alpha_f) h: a pendulum that moves through an angle where u' changes at once.
TEST(GeneralizedAlpha, FirstStepIsOfSecondOrder) {
  const double q0 = .7, u0 = 2.5;  // from the horizontal: q'' = g cos q
  std::printf("first step, rho_inf = 0.5\n%10s %14s %7s\n", "h [s]", "error of u1", "slope");
  double last = 0;
  for (const double h : {4e-2, 2e-2, 1e-2, 5e-3}) {
    machines::Run run(machines::pendulum(), h, 0.5);
    run.restart([&](State& s) { s.q[0] = q0, s.u[0] = u0; });
    run.advance(1);
    machines::Run fine(machines::pendulum(), h / 1000, 0.5);
    fine.restart([&](State& s) { s.q[0] = q0, s.u[0] = u0; });
    fine.advance(1000);
    const double error = std::abs(run.state.u[0] - fine.state.u[0]);
    std::printf("%10.1e %14.3e %7s\n", h, error, slope_text(last, error).c_str());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 3, .2);  // local error of a method of second order
    }
    last = error;
  }
}

TEST(GeneralizedAlpha, ChangeOfStepKeepsOrderTwo) {
  // Without re-centring a, the error of this run falls with h only.
  const double exact_x = 0.986291751131875, exact_y = -0.165010853125541;
  double last = 0;
  for (int n = 500; n <= 4000; n *= 2) {
    const double h = 1.0 / n;
    machines::Run run(machines::pendulum(), .75 * h, 0.6);
    for (int i = 0; i < n; ++i) {
      run.integrator.step(run.system, run.state, .75 * h);
      run.integrator.step(run.system, run.state, .25 * h);
    }
    const double error = (run.position(0) - Vector3d(exact_x, exact_y, 0)).norm();
    std::printf("steps of 3/4 and 1/4 of %.1e s: error %.3e, slope %s\n", h, error,
                slope_text(last, error).c_str());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, .1);
    }
    last = error;
  }
}

TEST(GeneralizedAlpha, JumpMovesBothAccelerationsByTheSame) {
  scene::Scene scene = machines::menagerie();
  machines::Run run(scene, 1e-3);
  run.advance(5);
  const State before = run.state;
  run.state.loads.col(1) = spatial(Vector3d(1, 2, 3), Vector3d(40, -50, 60));
  run.integrator.jump(run.system, run.state);
  EXPECT_GT((run.state.udot - before.udot).norm(), 10);
  EXPECT_LT(((run.state.a - before.a) - (run.state.udot - before.udot)).norm(), 1e-11);
  EXPECT_LT(run.system.residual(run.state).norm(), 1e-10);
  EXPECT_EQ(run.state.q, before.q);
  EXPECT_EQ(run.state.u, before.u);
}

TEST(GeneralizedAlpha, NewtonConvergesInAFewIterations) {
  machines::Run run(machines::menagerie(), 1e-3, 0.8, {1e-10, 20});
  run.advance(1000);
  const StepCounters& c = run.integrator.counters();
  std::printf("menagerie, h = 1e-3 s: %.2f iterations and %.2f factorisations per step\n",
              double(c.newton_iterations) / double(c.steps), double(c.factorisations) / double(c.steps));
  EXPECT_LT(c.newton_iterations, 4 * c.steps);
  EXPECT_LT(c.factorisations, 2 * c.steps);
}

// A body on a spring stretched by `stretch`, in any direction, under gravity: it swings by that distance, or
// by twice that where steps do not resolve the vibration. A second root of each step is on the other side of
// the anchor.
TEST(GeneralizedAlpha, StaysOnItsSideOfASpringsAnchor) {
  std::printf("%9s %9s %9s %12s %8s\n", "k [N/m]", "length", "h [s]", "distance", "in parts");
  for (const double stiffness : {1e6, 1e8, 1e10, 1e12, 4e12, 1e14})
    for (const double length : {1., 30.})
      for (const double h : {1e-4, 1e-3, 1e-2})
        for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(.48, -.6, .64), Vector3d(0, 0, -1)}) {
          const double stretch = 1e-6 * length;
          scene::Scene scene = machines::empty({0, -9.81, 0});
          const Vector3d p = length * direction;
          const Vec3d at{p.x(), p.y(), p.z()};
          const BodyId body = machines::add_body(scene, "b", 1, {1e-3, 1e-3, 1e-3}, at);
          scene.mbd->forces.push_back(
              scene::SpringDamper{"s", ground, body, {0, 0, 0}, at, stiffness, 0, length - stretch});
          machines::Run run(scene, h, .8, {1e-10, 20});
          double furthest = 0;
          for (int i = 0; i < 20; ++i) {
            run.advance(1);
            furthest = std::max(furthest, std::abs(run.position(0).norm() - length));
          }
          if (direction.x() == 1)
            std::printf("%9.0e %9.0e %9.0e %12.3e %8d\n", stiffness, length, h, furthest,
                        static_cast<int>(run.integrator.shortened().count));
          EXPECT_LT(furthest, 3 * stretch + 100 / stiffness) << stiffness << " " << length << " " << h;
        }
}

// A step taken in parts counts as one of its whole length, and all decisions are made within it.
TEST(GeneralizedAlpha, TakesAStepInPartsWhereNewtonFails) {
  const NewtonSettings few{1e-13, 4};
  machines::Run run(machines::pendulum(), .2, .9, few), fine(machines::pendulum(), 1e-4, .9);
  run.advance(2);
  const State saved = run.state;
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t before = run.integrator.shortened().count;
    run.advance(1);
    const bool in_parts = run.integrator.shortened().count > before;
    // Of two halves or more, each with an eighth of the error that the step would have.
    const double whole = std::abs(run.integrator.constants().error_constant()) * std::pow(.2, 3) *
                         run.system.norm(run.state.udot_rate);
    EXPECT_EQ(run.integrator.error_of_parts().has_value(), in_parts);
    if (!in_parts) continue;
    std::printf("local error of the parts %.3g, of a whole step with the rate of the last part %.3g\n",
                *run.integrator.error_of_parts(), whole);
    EXPECT_GT(*run.integrator.error_of_parts(), 0);
    EXPECT_LT(*run.integrator.error_of_parts(), whole);
  }
  const ShortenedSteps& s = run.integrator.shortened();
  std::printf(
      "pendulum, steps of 0.2 s and four iterations: %d in parts, first at %.3g s, shortest %.3g s, at %s\n",
      static_cast<int>(s.count), s.first_time, s.shortest, s.worst.c_str());
  EXPECT_GT(s.count, 0u);
  EXPECT_GT(run.integrator.counters().rejected, 0u);
  EXPECT_LT(s.shortest, .2);
  EXPECT_EQ(s.doubtful, 0u);
  EXPECT_NE(s.worst.find("joint \"pin\""), std::string::npos);
  EXPECT_NEAR(run.state.time, 1, 1e-15);
  fine.advance(10000);
  EXPECT_NEAR(run.state.q[0], fine.state.q[0], .1);

  machines::Run resumed(machines::pendulum(), .2, .9, few);
  resumed.state = saved;
  resumed.advance(3);
  EXPECT_EQ(hash(resumed.state), hash(run.state));
}

// The steps of a pendulum, every fifth in two halves.
TEST(GeneralizedAlpha, StepsInPartsKeepOrderTwo) {
  const double exact_x = 0.986291751131875, exact_y = -0.165010853125541;
  double last = 0;
  for (int n = 125; n <= 1000; n *= 2) {
    const double h = 1.0 / n;
    machines::Run run(machines::pendulum(), h, .9);
    GeneralizedAlpha refusing(.9, {1e-30, 1}, run.system, run.state);  // cannot take any step
    for (int i = 0; i < n; ++i) {
      State& state = run.state;
      if (i % 5 == 2) {
        // Like step() after one failure: two halves, the next step whole.
        const State before = state;
        EXPECT_FALSE(refusing.try_step(run.system, state, h));
        EXPECT_EQ(hash(before), hash(state));
        run.integrator.step(run.system, state, h / 2);
        run.integrator.step(run.system, state, h / 2);
      } else {
        run.integrator.step(run.system, state, h);
      }
    }
    const double error = (run.position(0) - Vector3d(exact_x, exact_y, 0)).norm();
    std::printf("every fifth step of %.1e s in two parts: error %.3e, slope %s\n", h, error,
                slope_text(last, error).c_str());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, .1);
    }
    last = error;
  }
}

#ifdef COUNT_ALLOCATIONS
// With loops, redundant equations, couplers, contacts with stops, friction, tables and a bushing.
TEST(GeneralizedAlpha, StepOfAWorkshopDoesNotAllocate) {
  for (const Constraints form : {Constraints::index2, Constraints::index3}) {
    machines::Run run(workshop(), 1e-3, .9, {1e-10, 20}, form);
    ASSERT_FALSE(run.assembly.redundant.empty());
    run.advance(2);
    double furthest = 0;
    const std::size_t before = allocations;
    run.state.loads.col(0) = spatial(Vector3d(1, 2, 3), Vector3d(4, 5, 6));
    run.integrator.jump(run.system, run.state);
    for (int i = 0; i < 300; ++i) {
      run.advance(1);
      furthest =
          std::max(furthest, std::abs(run.state.q[run.model.links[run.model.joints[5].coordinate_link].q]));
    }
    EXPECT_EQ(allocations - before, 0u);
    EXPECT_GT(furthest, .01) << "the rack did not reach a stop";
  }
}

TEST(GeneralizedAlpha, PassingSingularPositionsDoesNotAllocate) {
  machines::Run run(machines::ladder(8), 1e-3, .9, {1e-10, 20});
  run.advance(700);
  const std::size_t before = allocations;
  run.advance(50);
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_LT(run.state.q[run.model.links[1].q], -std::acos(0.0)) << "theta = 0 was not passed";
}

TEST(GeneralizedAlpha, ErrorControlDoesNotAllocate) {
  machines::Run run(workshop(), 1e-3);
  const StepControl control({.tolerance = 1e-6, .max_step = .02});
  control.step(run.integrator, run.system, run.state, 1);
  const std::size_t before = allocations;
  while (run.state.time < .3) control.step(run.integrator, run.system, run.state, 1);
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_GT(run.integrator.counters().rejected, 0u);
}

void expect_windows_without_allocation(bool extrapolate) {
  scene::Scene scene = workshop();
  scene.mbd->integrator.step = 4e-4;
  scene.end_time = .1;
  scene.mbd->integrator.extrapolate = extrapolate;
  scene.mbd->forces.push_back(scene::Actuator{"brake", JointId{4}, {}, "brake_torque"});
  MbdSolver solver;
  solver.configure(scene);
  protocol::LoadSet loads;
  loads.bodies.resize(2);
  loads.bodies[0].body = 1, loads.bodies[1].body = 6;
  protocol::ControlSet inputs;
  inputs.values = {0};
  const auto window = [&](std::uint64_t n) {
    const auto begin = static_cast<std::int64_t>(n) * 1'000'000;
    loads.window = {n, {begin}, {begin + 1'000'000}};
    loads.bodies[0].mean.force = {0, std::sin(double(n)), 1};
    inputs.time = {begin};
    inputs.values[0] = .01 * std::cos(double(n));
    solver.control(inputs);
    solver.save();
    solver.predict(loads.window);
    solver.advance(loads);
    solver.restore();
    solver.advance(loads);
    solver.observe();
  };
  window(0);
  const std::size_t before = allocations;
  for (std::uint64_t n = 1; n < 100; ++n) window(n);
  EXPECT_EQ(allocations - before, 0u);
}
TEST(GeneralizedAlpha, WindowDoesNotAllocate) {
  expect_windows_without_allocation(false);
}
TEST(Richardson, WindowDoesNotAllocate) {
  expect_windows_without_allocation(true);
}

TEST(GeneralizedAlpha, StepDoesNotAllocate) {
  machines::Run run(machines::menagerie(), 1e-3);
  run.advance(2);
  const std::size_t before = allocations;
  run.state.loads.col(0) = spatial(Vector3d(1, 2, 3), Vector3d(4, 5, 6));
  run.integrator.jump(run.system, run.state);
  run.advance(100);
  EXPECT_EQ(allocations - before, 0u);
  const auto* volatile probe = new int(1);  // checks the counter
  EXPECT_GT(allocations, before);
  delete probe;
}
#endif

TEST(GeneralizedAlpha, SaysWhereNewtonFails) {
  machines::Run run(machines::pendulum(), 0.5, 0.8, {1e-12, 1});
  try {
    run.advance(10);
    FAIL() << "one iteration cannot be enough";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_NE(error.problem().find("joint \"pin\" of body \"mass\""), std::string::npos) << error.what();
    EXPECT_NE(error.hint().find("mbd.integrator.step"), std::string::npos) << error.what();
  }
}

TEST(GeneralizedAlpha, SaysWhereTheMassMatrixIsSingular) {
  scene::Scene scene = machines::empty();
  const BodyId point = machines::add_body(scene, "point", 1, {0, 0, 0}, {0, 0, 0});
  machines::add_joint(scene, "pin", scene::JointType::revolute, ground, point, {0, 0, 0});
  try {
    machines::Run run(scene, 1e-3);
    FAIL() << "a point mass on its own axis has no inertia";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_NE(error.problem().find("joint \"pin\" of body \"point\""), std::string::npos) << error.what();
  }
}

TEST(GeneralizedAlpha, SaysThatASpringHasNoDirection) {
  scene::Scene scene = machines::pendulum();
  scene.mbd->forces.push_back(
      scene::SpringDamper{"rope", ground, BodyId{0}, {-1, 0, 0}, {-1, 0, 0}, 10, 0, 1});
  try {
    machines::Run run(scene, 1e-3);
    FAIL() << "the ends meet";
  } catch (const Error& error) {
    EXPECT_NE(error.problem().find("spring \"rope\""), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tandem::mbd
