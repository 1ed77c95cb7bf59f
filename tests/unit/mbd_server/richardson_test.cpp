// Extrapolation of two runs: its order, on the group and with loops; jumps of loads; restarts.
#include "mbd_server/step/richardson.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <vector>

#include "common/error.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "mbd_server/io/state_file.hpp"
#include "tests/unit/mbd_server/workshop.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

struct Extrapolated {
  machines::Run run;
  Richardson richardson;

  Extrapolated(const scene::Scene& scene, double h, double rho_inf = .9)
      : run(scene, h, rho_inf), richardson(run.integrator, run.state) {
    richardson.start(run.system, run.state, h);
  }
  void advance(int steps) {
    for (int i = 0; i < steps; ++i) richardson.step(run.system, run.state, run.step);
  }
};

// Largest difference of the coordinates to a fine run's.
double error(const machines::Run& run, const State& exact) {
  VectorXd x = exact.u;
  run.system.difference(exact.q, run.state.q, x);
  return x.cwiseAbs().maxCoeff();
}

// The errors of both over three halvings. The next term after the second order is the third, small at rho_inf
// = .9. `round_off` is that of the multipliers [N, N m].
void expect_order(const char* name, const scene::Scene& scene, double end, int first,
                  double round_off = 1e-10) {
  Extrapolated fine(scene, end / (64 * first));
  fine.advance(64 * first);
  std::printf("%s, t = %g s\n%12s %13s %13s %13s %11s\n", name, end, "h [s]", "method", "extrapolated",
              "multipliers", "constraint");
  std::vector<double> coordinates, multipliers;
  for (int n = first; n <= 8 * first; n *= 2) {
    machines::Run plain(scene, end / n);
    Extrapolated run(scene, end / n);
    plain.advance(n), run.advance(n);
    run.run.system.residual(run.run.state);
    coordinates.push_back(error(run.run, fine.run.state));
    multipliers.push_back((run.run.state.lambda - fine.run.state.lambda).norm());
    const VectorXd& phi = run.run.system.constraint(Level::position);
    std::printf("%12.3e %13.3e %13.3e %13.3e %11.1e\n", end / n, error(plain, fine.run.state),
                coordinates.back(), multipliers.back(), phi.size() > 0 ? phi.cwiseAbs().maxCoeff() : 0);
    if (n == first) {
      EXPECT_LT(100 * coordinates.back(), error(plain, fine.run.state));
    }
  }
  // From the largest step down to the round-off of the two runs.
  const auto slope = [](const std::vector<double>& errors, double smallest) {
    std::size_t last = 0;
    while (last + 1 < errors.size() && errors[last + 1] > smallest) ++last;
    return std::log2(errors[0] / errors[last]) / static_cast<double>(last);
  };
  const double of_coordinates = slope(coordinates, 1e-12);
  std::printf("%12s %27.2f", "slope", of_coordinates);
  EXPECT_GT(of_coordinates, 2.7);
  if (fine.run.model.equations > 0) {
    const double of_multipliers = slope(multipliers, round_off);
    std::printf(" %13.2f", of_multipliers);
    EXPECT_GT(of_multipliers, 2.7);
  }
  std::printf("\n");
}

TEST(Richardson, CancelsTheErrorOfSecondOrder) {
  expect_order("pendulum", machines::pendulum(), 1, 128);
  expect_order("free asymmetric body", machines::shipped("flipping_body"), 1, 128);
  expect_order("heavy top on a cut ball joint", machines::shipped("heavy_top"), .1, 256, 3e-7);
  expect_order("A02, N = 2", machines::ladder(2), .5, 128);
  expect_order("A04 Bricard, redundant", machines::shipped("bricard"), .5, 64);
  expect_order("menagerie", machines::menagerie(), .5, 256);
}

// One spring period in 0.2 steps: each run remains stable, and so does the extrapolation.
TEST(Richardson, StaysBoundedOnUnresolvedSprings) {
  Extrapolated run(machines::shipped("closed_chain"), 1e-2, .8);
  run.advance(1000);
  EXPECT_LT(run.run.state.q.cwiseAbs().maxCoeff(), 100);
  EXPECT_TRUE(run.run.state.u.allFinite());
}

// A free body under loads that jump at each window gains their impulse, whether constant or linear in time.
TEST(Richardson, GivesTheImpulseOfLoads) {
  scene::Scene scene = machines::free_body(2, {1, 1, 1}, {0, 0, 0});
  machines::add_wall(scene, BodyId{0});
  scene.mbd->integrator.extrapolate = true;
  scene.mbd->integrator.step = 5e-4;
  MbdSolver solver;
  solver.configure(scene);
  protocol::LoadSet loads;
  loads.bodies.resize(1);
  loads.bodies[0].body = 0;
  double impulse = 0;
  for (std::int64_t n = 0; n < 20; ++n) {
    loads.window = {static_cast<std::uint64_t>(n), {n * 1'000'000}, {(n + 1) * 1'000'000}};
    loads.bodies[0].mean.force = {double(3 * n % 7), 0, 0};
    loads.bodies[0].first_moment.force = {1e-7 * double(n % 3), 0, 0};
    impulse += 1e-3 * loads.bodies[0].mean.force.x;
    const protocol::MotionSet& motion = solver.advance(loads);
    EXPECT_NEAR(2 * motion.bodies[0].end_twist.v_WB.x, impulse, 1e-13);
  }
}

TEST(Richardson, RestoredRunsContinueToTheSameBits) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tandem_richardson_" + std::to_string(getpid()) + ".h5");
  Extrapolated straight(workshop(), 1e-3), copied(workshop(), 1e-3), resumed(workshop(), 1e-3);
  straight.advance(50), copied.advance(50);
  write_state(path, straight.run.model, straight.run.state);
  const State saved = copied.run.state;
  copied.advance(7);
  copied.run.state = saved;
  resumed.run.state = read_state(path, resumed.run.model).state;
  std::filesystem::remove(path);
  for (Extrapolated* run : {&straight, &copied, &resumed}) run->advance(50);
  EXPECT_EQ(copied.run.state.lambda, straight.run.state.lambda);
  EXPECT_EQ(hash(copied.run.state), hash(straight.run.state));
  EXPECT_EQ(hash(resumed.run.state), hash(straight.run.state));
}

TEST(Richardson, RefusesAStateWithoutItsRuns) {
  Extrapolated run(machines::pendulum(), 1e-3);
  run.run.state.coarse.resize(0);
  EXPECT_THROW(run.advance(1), Error);
}

}  // namespace
}  // namespace tandem::mbd
