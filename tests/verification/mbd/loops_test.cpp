// Closed loops against exact values in position, velocity and multipliers: A01 in cut-joint form, A02 with N
// windows, A04 with its redundant equation, the heavy top on a cut ball joint.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace loops_test {

constexpr double g = 9.81;
const std::vector<std::string> columns{"position", "velocity", "multipliers"};
const NewtonSettings sharp{1e-13, 30};
// An error of the position counts 1 / (beta h^2) times in the multipliers of index 3: round-off sets in
// earlier.
const NewtonSettings less_sharp{1e-12, 30};
NewtonSettings newton(Constraints form) {
  return form == Constraints::index2 ? sharp : less_sharp;
}
// Steps per second of the coarsest run.
int first(Constraints form) {
  return form == Constraints::index2 ? 512 : 128;
}

const char* name_of(Constraints form) {
  return form == Constraints::index2 ? "index 2" : "index 3";
}
Vector3d force(machines::Run& run, const std::string& joint) {
  return to_eigen(run.joint(joint).reaction.force);
}

// ---- A01: v^2 = -2 g y, and the bar passes 3 m g y along itself.

const Vector3d pendulum_after_1s(0.986291751131875, -0.165010853125541, 0);

std::vector<double> pendulum_errors(machines::Run& run) {
  const Vector3d x = pendulum_after_1s, v = std::sqrt(-2 * g * x.y()) * Vector3d(-x.y(), x.x(), 0);
  return {(run.position(0) - x).norm(), (run.velocity(0) - v).norm(),
          (force(run, "hinge") - 3 * g * x.y() * x).norm()};
}

TEST(CutPendulum, FollowsTheClosedForm) {
  for (const Constraints form : {Constraints::index2, Constraints::index3}) {
    OrderTable table(std::string("A01 on a cut hinge, t = 1 s, ") + name_of(form), columns);
    for (int n = first(form); n <= 8 * first(form); n *= 2) {
      machines::Run run(machines::shipped("simple_pendulum_cut"), 1.0 / n, 0.9, newton(form), form);
      run.advance(n);
      table.add(1.0 / n, pendulum_errors(run));
    }
    table.expect_order(2.0, 0.1);
  }
}

TEST(CutPendulum, ReachesTheExactPositionAtASmallStep) {
  machines::Run run(machines::shipped("simple_pendulum_cut"), 1.0 / 32768, 0.9, sharp);
  const double cpu = run.advance_timed(32768);
  expect_within("A01 on a cut hinge, t = 1 s, h = 3.1e-5 s", pendulum_errors(run)[0], 1e-8, "m", cpu);
}

// ---- A02: theta'' = -c g cos theta, c = [(N+1)/2 + N] / [(N+1)/3 + N], theta(0) = pi/2, theta'(0) = -1.

struct Ladder {
  int windows;
  double c = ((windows + 1) / 2.0 + windows) / ((windows + 1) / 3.0 + windows);
  double angle = 0, rate = 0;

  // Runge-Kutta with steps of 1e-4 s: exact to 1e-13.
  Ladder(int n, double t) : windows(n) {
    const auto slope = [&](const Eigen::Vector2d& y) {
      return Eigen::Vector2d(y[1], -c * g * std::cos(y[0]));
    };
    Eigen::Vector2d y(std::acos(0.0), -1);
    const int steps = static_cast<int>(std::lround(t * 1e4));
    const double h = t / steps;
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d k1 = slope(y), k2 = slope(y + h / 2 * k1), k3 = slope(y + h / 2 * k2),
                            k4 = slope(y + h * k3);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    angle = y[0], rate = y[1];
  }
  Vector3d top() const { return {std::cos(angle), std::sin(angle), 0}; }
  Vector3d velocity() const { return rate * Vector3d(-std::sin(angle), std::cos(angle), 0); }
  // From the first bar to the second vertical. A bar only translates: its ends share the weight and the
  // vertical inertia force equally, and each vertical asks the same moment of its bars.
  Vector3d force_on_second_vertical() const {
    const double acceleration = -c * g * std::cos(angle);
    const Vector3d across(-std::sin(angle), std::cos(angle), 0);
    const Vector3d bar =
        acceleration * across - rate * rate * top() + Vector3d(0, g, 0);  // both ends give to a bar
    const double moment = acceleration / 3 + g / 2 * std::cos(angle);     // on each vertical
    const double y = bar.y() / 2;
    const double first_x =
        (moment + y * across.y()) / -across.x();  // given by vertical 0: -(x, y) . across = moment
    return -Vector3d(bar.x() - first_x, y, 0);
  }
};

// B0, the top of the first vertical, is twice as far as its centre of mass.
std::vector<double> ladder_errors(machines::Run& run, const Ladder& exact) {
  return {(2 * run.position(0) - exact.top()).norm(), (2 * run.velocity(0) - exact.velocity()).norm(),
          (force(run, "c0") - exact.force_on_second_vertical()).norm()};
}

TEST(Ladder, OfTwoWindowsFollowsTheClosedForm) {
  const Ladder exact(2, 1);
  EXPECT_LT((exact.top() - Vector3d(-0.195020301949435, -0.980799205662174, 0)).norm(), 1e-12);
  for (const Constraints form : {Constraints::index2, Constraints::index3}) {
    OrderTable table(std::string("A02, N = 2, t = 1 s, ") + name_of(form), columns);
    for (int n = first(form); n <= 8 * first(form); n *= 2) {
      machines::Run run(machines::shipped("four_bars"), 1.0 / n, 0.9, newton(form), form);
      EXPECT_EQ(run.assembly.redundant.size(), 6u);
      run.advance(n);
      table.add(1.0 / n, ladder_errors(run, exact));
    }
    table.expect_order(2.0, 0.1);
  }
}

TEST(Ladder, ReachesTheExactPositionAtASmallStep) {
  const Ladder exact(2, .5);
  machines::Run run(machines::shipped("four_bars"), .5 / 16384, 0.9, sharp);
  const double cpu = run.advance_timed(16384);
  expect_within("A02, N = 2, t = 0.5 s, h = 3.1e-5 s", ladder_errors(run, exact)[0], 1e-8, "m", cpu);
}

TEST(Ladder, KeepsItsEnergyThroughSingularPositions) {
  machines::Run run(machines::shipped("four_bars"), 1e-3, 0.9, {1e-10, 20});
  const double start = run.energy();
  double worst = 0, cpu = 0;
  for (int i = 0; i < 10000; ++i) {
    cpu += run.advance_timed(1);
    worst = std::max(worst, std::abs(run.energy() - start));
  }
  expect_within("A02, N = 2, h = 1e-3 s, energy over 10 s", worst, 1.1e-3, "J", cpu);
  std::printf("B0 after 10 s is off by %.2e m\n", ladder_errors(run, Ladder(2, 10))[0]);
}

// Launched by hand, `launch/scenes/mbd/make.py --windows 1000` gives the longer scene.
TEST(Ladder, OfManyWindowsFollowsTheSameClosedForm) {
  for (const auto& [windows, steps] : {std::pair{40, 1000}, std::pair{1000, 20}}) {
    machines::Run run(machines::ladder(windows), 1e-3, 0.9, {1e-10, 30});
    const double cpu = run.advance_timed(steps);
    std::printf("%.2f us per step and window; ", 1e6 * cpu / steps / windows);
    expect_within("A02, N = " + std::to_string(windows) + ", " + std::to_string(steps) + " steps",
                  ladder_errors(run, Ladder(windows, 1e-3 * steps))[0], 1e-6, "m", cpu);
  }
}

// The last step ends `beside` the first singular position, theta = 0 [rad], after ten from exact values; then
// ten more. The multipliers grow with 1 / sin(theta) there, and so would the round-off of what they are made
// of.
void pass_singular_position(int windows, double beside) {
  constexpr double h = 1e-3;
  const auto angle = [&](double t) { return Ladder(windows, t).angle; };
  double low = .7, high = .75;
  while (high - low > 1e-13) (angle((low + high) / 2) > beside ? low : high) = (low + high) / 2;
  const double first = low - 10 * h;

  const Ladder begin(windows, first);
  machines::Run run(machines::ladder(windows), h, 0.9, {1e-10, 20});
  run.restart([&](State& s) {
    for (int body = 0; body <= 2 * windows; ++body) {
      const Link& link = run.model.links[run.model.bodies[body].link];
      // Bars do not turn: against their vertical they turn back.
      const double sign = body <= windows ? 1 : -1;
      s.q[link.q] = sign * (begin.angle - std::acos(0.0));
      s.u[link.u] = sign * begin.rate;
    }
  });
  ASSERT_LT(run.system.constraint(Level::position).cwiseAbs().maxCoeff(), 1e-12);
  run.advance(10);
  const double landed = run.state.q[run.model.links[run.model.bodies[0].link].q] + std::acos(0.0);
  const double largest = run.state.lambda.cwiseAbs().maxCoeff();
  run.advance(10);
  const double error = ladder_errors(run, Ladder(windows, first + 20 * h))[0];
  std::printf("%8d %12.1e %12.1e %14.1e %12.2e\n", windows, beside, landed, largest, error);
  EXPECT_LT(error, 1e-6);
}

TEST(Ladder, PassesSingularPositionsHoweverNearAStepEnds) {
  std::printf("A02, 20 steps of 1e-3 s past theta = 0\n%8s %12s %12s %14s %12s\n", "windows", "aim [rad]",
              "reached", "multiplier [N]", "error [m]");
  for (const int windows : {2, 40, 1000})
    for (const double beside : {1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 0.}) pass_singular_position(windows, beside);
}

// ---- A04: hinge angles (p, r, p, r, p, r), sin r = -sin p / (1 + sin p).

struct Bricard {
  double p, p_rate;  // from the reduced equation, see the checks of the scene
  double r() const { return -std::asin(std::sin(p) / (1 + std::sin(p))); }
  double r_rate() const { return -p_rate * std::cos(p) / std::pow(1 + std::sin(p), 2) / std::cos(r()); }
};

// Multipliers of the exact position and rates, by the solver's start: minimum-norm as any.
VectorXd exact_multipliers(const scene::Scene& scene, const Bricard& exact) {
  machines::Run run(scene, 1e-4);
  run.restart([&](State& s) {
    for (std::size_t j = 0; j < run.model.joints.size(); ++j) {
      const LinkIndex link = run.model.joints[j].coordinate_link;
      if (link == none) continue;
      // The last joint is seen from the ground, which closes the ring.
      const double sign = j == 5 ? -1 : 1;
      s.q[run.model.links[link].q] = sign * (j % 2 == 0 ? exact.p : exact.r());
      s.u[run.model.links[link].u] = sign * (j % 2 == 0 ? exact.p_rate : exact.r_rate());
    }
  });
  EXPECT_LT(run.system.constraint(Level::position).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT(run.system.constraint(Level::velocity).cwiseAbs().maxCoeff(), 1e-11);
  return run.state.lambda;
}

std::vector<double> bricard_errors(machines::Run& run, const Bricard& exact, const VectorXd& multipliers) {
  const JointObservation first = run.joint("p0");
  return {std::abs(first.q - exact.p), std::abs(first.rate - exact.p_rate),
          (run.state.lambda - multipliers).norm()};
}

TEST(Bricard, NamesItsRedundantEquation) {
  machines::Run run(machines::shipped("bricard"), 1e-3);
  ASSERT_EQ(run.assembly.redundant.size(), 1u);
  std::printf("redundant: %s\n", run.assembly.redundant[0].c_str());
  EXPECT_EQ(run.assembly.degrees_of_freedom, 1);
}

TEST(Bricard, FollowsTheReducedEquation) {
  const scene::Scene scene = machines::shipped("bricard");
  const Bricard exact{scene.checks[0].expected, scene.checks[1].expected};
  // P2 of the notes: ((1 + sin r) cos p, -cos r, -(1 + sin r) sin p).
  const double u = 1 + std::sin(exact.r());
  EXPECT_LT((Vector3d(u * std::cos(exact.p), -std::cos(exact.r()), -u * std::sin(exact.p)) -
             Vector3d(0.2744813193, -0.8867079387, -0.4623300027))
                .norm(),
            1e-9);
  const VectorXd multipliers = exact_multipliers(scene, exact);
  for (const Constraints form : {Constraints::index2, Constraints::index3}) {
    OrderTable table(std::string("A04 Bricard, t = 1 s, ") + name_of(form), columns);
    for (int n = first(form) / 2; n <= 4 * first(form); n *= 2) {
      machines::Run run(scene, 1.0 / n, 0.9, newton(form), form);
      run.advance(n);
      table.add(1.0 / n, bricard_errors(run, exact, multipliers));
    }
    table.expect_order(2.0, 0.1);
  }
  machines::Run run(scene, 1.0 / 16384, 0.9, sharp);
  const double cpu = run.advance_timed(16384);
  expect_within("A04 Bricard, t = 1 s, h = 6.1e-5 s", bricard_errors(run, exact, multipliers)[0], 1e-8, "rad",
                cpu);
}

// Of all multipliers that give the same forces, those of the run are the shortest: every change in the null
// space of G^T, found by an independent factorisation, is perpendicular to them.
TEST(Bricard, HasMinimumNormMultipliers) {
  machines::Run run(machines::shipped("bricard"), 1e-3, 0.9, sharp);
  run.advance(500);
  const int n = run.model.freedoms, m = run.model.equations;
  Eigen::MatrixXd G(m, n);
  const double e = 1e-6;
  for (int j = 0; j < n; ++j) {
    VectorXd phi[2];
    for (int k = 0; k < 2; ++k) {
      State s = run.state;
      VectorXd x = VectorXd::Zero(n);
      x[j] = k == 0 ? -e : e;
      run.system.move(run.state.q, x, s.q);
      run.system.residual(s);
      phi[k] = run.system.constraint(Level::position);
    }
    G.col(j) = (phi[1] - phi[0]) / (2 * e);
  }
  // In forces: multipliers that are torques are divided by the size.
  const VectorXd arm = Eigen::Map<const VectorXd>(run.model.force_arm.data(), m);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(G.transpose() * arm.asDiagonal(), Eigen::ComputeFullV);
  std::printf("A04 singular values of G: %.3e ... %.3e %.3e\n", svd.singularValues()[0],
              svd.singularValues()[m - 2], svd.singularValues()[m - 1]);
  EXPECT_LT(svd.singularValues()[m - 1], 1e-8);
  EXPECT_GT(svd.singularValues()[m - 2], 1e-3);
  const VectorXd forces = run.state.lambda.cwiseQuotient(arm);
  EXPECT_GT(forces.norm(), 1);
  EXPECT_LT(std::abs(svd.matrixV().col(m - 1).dot(forces)), 1e-7 * forces.norm());
}

}  // namespace loops_test
}  // namespace tandem::mbd
