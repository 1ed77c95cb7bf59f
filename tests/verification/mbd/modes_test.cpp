// Equilibria and natural modes against closed forms.
#include "mbd_server/solve/modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace modes_test {

using scene::JointType;

constexpr double g = 9.81;

void stop(scene::Scene& scene) {
  for (scene::Body& body : scene.mbd->bodies) body.twist = {};
  for (scene::Joint& joint : scene.mbd->joints) joint.rate = 0;
}

// A machine in its equilibrium.
struct AtRest {
  explicit AtRest(const scene::Scene& scene) : run(scene, 1e-3) {
    run.state.u.setZero();
    report = find_equilibrium(run.model, run.system, run.state);
    modes = find_modes(run.model, run.system, run.state);
  }
  // Angular frequencies of the modes that oscillate, ascending [rad/s].
  std::vector<double> frequencies() const {
    std::vector<double> w;
    for (const Mode& mode : modes.modes)
      if (mode.s.imag() > 0) w.push_back(std::abs(mode.s));
    return w;
  }
  machines::Run run;
  EquilibriumReport report;
  Modes modes;
};

void compare(const std::string& what, double measured, double expected, double tolerance) {
  std::printf("%-52s expected %.10g measured %.10g relative error %.2e tolerance %.0e\n", what.c_str(),
              expected, measured, std::abs(measured / expected - 1), tolerance);
  EXPECT_NEAR(measured / expected, 1, tolerance) << what;
}

TEST(Modes, MassOnASpringWithADamper) {
  const double m = 2, k = 800;
  for (const double zeta : {0.0, 0.1, 0.9, 3.0}) {
    scene::Scene scene = machines::empty();
    const BodyId body = machines::add_body(scene, "mass", m, {1, 1, 1}, {0, 0, 0});
    machines::add_joint(scene, "rail", JointType::prismatic, ground, body, {0, 0, 0});
    scene.mbd->forces.push_back(
        scene::SpringDamper{"spring", ground, body, {0, 0, 2}, {0, 0, 0}, k, 2 * zeta * std::sqrt(k * m), 2});
    AtRest machine(scene);
    EXPECT_NEAR(machine.run.position(0).z(), -m * g / k, 1e-12);
    ASSERT_EQ(machine.modes.modes.size(), zeta < 1 ? 1U : 2U);
    const double w = std::sqrt(k / m);
    if (zeta < 1) {
      compare("frequency", machine.modes.modes[0].frequency(), w / (2 * std::numbers::pi), 1e-12);
      EXPECT_NEAR(machine.modes.modes[0].damping_ratio(), zeta, 1e-12);
    } else {
      compare("slow decay", -machine.modes.modes[0].s.real(), w * (zeta - std::sqrt(zeta * zeta - 1)), 1e-10);
      compare("fast decay", -machine.modes.modes[1].s.real(), w * (zeta + std::sqrt(zeta * zeta - 1)), 1e-10);
    }
  }
}

// Hanging chain of uniform rods in absolute angles, from the horizontal:
//   M_ij = m L^2 (N - max(i, j) + 1/2), M_ii = m L^2 (N - i + 1/3), K_ii = m g L (N - i + 1/2), i from 1.
TEST(Modes, HangingChains) {
  for (const int n : {1, 2, 10, 40}) {
    const double L = 0.1;
    Eigen::MatrixXd M(n, n), K = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) M(i, j) = L * L * (n - 1 - std::max(i, j) + (i == j ? 1.0 / 3 : 0.5));
      K(i, i) = g * L * (n - 1 - i + 0.5);
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> exact(K, M);
    AtRest machine(machines::chain(n));
    std::printf("chain of %d links: equilibrium in %d iterations from the horizontal\n", n,
                machine.report.iterations);
    // The chain of machines::chain() lies along x, and gravity acts along -y.
    EXPECT_LT((machine.run.position(n - 1) - Vector3d(0, -L * (n - 0.5), 0)).norm(), 1e-9) << "hangs";
    const std::vector<double> w = machine.frequencies();
    ASSERT_EQ(w.size(), static_cast<std::size_t>(n));
    double worst = 0;
    for (int i = 0; i < n; ++i)
      worst = std::max(worst, std::abs(w[i] / std::sqrt(exact.eigenvalues()[i]) - 1));
    compare("  lowest [rad/s]", w[0], std::sqrt(exact.eigenvalues()[0]), 1e-9);
    compare("  highest [rad/s]", w[n - 1], std::sqrt(exact.eigenvalues()[n - 1]), 1e-9);
    EXPECT_LT(worst, 1e-9);
  }
}

// A02 with its loops hanging down: theta'' = -g [(N+1)/2 + N] / [(N+1)/3 + N] cos theta about -pi/2.
TEST(Modes, LadderOfFourBars) {
  for (const int windows : {1, 2, 6}) {
    scene::Scene scene = machines::ladder(windows);
    stop(scene);
    // It stands upright, in its unstable equilibrium, which is found as such.
    AtRest upright(scene);
    const double n = windows, rate = std::sqrt(g * ((n + 1) / 2 + n) / ((n + 1) / 3 + n));
    ASSERT_EQ(upright.modes.modes.size(), 2U);
    compare("upright, growth [1/s]",
            upright.modes.modes.back().s.real() > 0 ? upright.modes.modes.back().s.real()
                                                    : upright.modes.modes.front().s.real(),
            rate, 1e-8);
  }
}

// A05 at rest in coordinates theta_1, theta_2 (rods below the horizontal) and s (slider); the shaft is free.
TEST(Modes, Governor) {
  scene::Scene scene = machines::shipped("governor");
  stop(scene);
  AtRest machine(scene);
  const double k = 8e5, c = 4e4, l0 = 0.5, rod = 0.3, ball = 5, slider = 3;
  const double inertia = rod * (1 + 1e-4) / 12 + rod * 0.25 + ball;
  using V3 = Eigen::Vector3d;
  const auto length = [](double theta, double s) {
    return std::hypot(0.5 * std::cos(theta), 1 - 0.5 * std::sin(theta) - s);
  };
  const auto potential = [&](const V3& q) {
    double v = slider * g * q[2];
    for (int i = 0; i < 2; ++i)
      v += g * (rod * (1 - 0.5 * std::sin(q[i])) + ball * (1 - std::sin(q[i]))) +
           0.5 * k * std::pow(length(q[i], q[2]) - l0, 2);
    return v;
  };
  const auto gradient = [&](const V3& q) {
    V3 d;
    for (int i = 0; i < 3; ++i) {
      const double e = 1e-6;
      d[i] = (potential(q + e * V3::Unit(i)) - potential(q - e * V3::Unit(i))) / (2 * e);
    }
    return d;
  };
  const auto hessian = [&](const V3& q) {
    Eigen::Matrix3d H;
    for (int i = 0; i < 3; ++i) {
      const double e = 1e-5;
      H.col(i) = (gradient(q + e * V3::Unit(i)) - gradient(q - e * V3::Unit(i))) / (2 * e);
    }
    return Eigen::Matrix3d((H + H.transpose()) / 2);
  };
  V3 q(std::numbers::pi / 6, std::numbers::pi / 6, 0.5);
  for (int i = 0; i < 50; ++i) q -= hessian(q).inverse() * gradient(q);
  const V3 M(inertia, inertia, slider);
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 2; ++i) {
    const double L = length(q[i], q[2]), across = -0.5 * std::cos(q[i]);
    const double dz = 1 - 0.5 * std::sin(q[i]) - q[2];
    V3 d = V3::Zero();  // of the length
    d[i] = (0.5 * std::cos(q[i]) * -0.5 * std::sin(q[i]) + dz * across) / L;
    d[2] = -dz / L;
    C += c * d * d.transpose();
  }
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A.topRightCorner(3, 3).setIdentity();
  A.bottomLeftCorner(3, 3) = Eigen::Matrix3d((-M.cwiseInverse()).asDiagonal()) * hessian(q);
  A.bottomRightCorner(3, 3) = Eigen::Matrix3d((-M.cwiseInverse()).asDiagonal()) * C;
  std::vector<std::complex<double>> exact;
  const Eigen::VectorXcd roots = Eigen::EigenSolver<Eigen::MatrixXd>(A).eigenvalues();
  for (const std::complex<double>& s : roots)
    if (s.imag() >= 0) exact.push_back(s);
  std::sort(exact.begin(), exact.end(), [](auto a, auto b) { return std::abs(a) < std::abs(b); });
  EXPECT_EQ(machine.modes.neutral, 1) << "the shaft";
  ASSERT_EQ(machine.modes.modes.size(), exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const std::complex<double> s = machine.modes.modes[i].s;
    std::printf("A05 mode %zu: expected %.8g %+.8gi measured %.8g %+.8gi 1/s tolerance 1e-5\n", i + 1,
                exact[i].real(), exact[i].imag(), s.real(), s.imag());
    EXPECT_LT(std::abs(s - exact[i]), 1e-5 * std::abs(exact[i]));
  }
}

TEST(Equilibrium, AMachineThatStartsThereStays) {
  for (const char* name : {"governor", "chain"}) {
    scene::Scene scene = name == std::string("chain") ? machines::chain(20) : machines::shipped(name);
    stop(scene);
    machines::Run run(scene, 1e-2);
    run.restart([&](State& state) {
      state.u.setZero();
      find_equilibrium(run.model, run.system, state);
    });
    std::vector<Vector3d> start;
    const int bodies = static_cast<int>(run.model.bodies.size());
    for (int b = 0; b < bodies; ++b) start.push_back(run.position(b));
    run.advance(1000);
    double moved = 0;
    for (int b = 0; b < bodies; ++b)
      moved = std::max(moved, (run.position(b) - start[static_cast<std::size_t>(b)]).norm());
    std::printf("%-10s moved %.2e m in 10 s (1e-8 allowed)\n", name, moved);
    EXPECT_LT(moved, 1e-8);
  }
}

// A wheel on its hinge, whose weight is a rounded number away from it.
TEST(Equilibrium, AFreeCoordinateStaysWhereItIs) {
  scene::Scene scene = machines::empty();
  const BodyId wheel = machines::add_body(scene, "wheel", 30, {2, 1.2, 2}, {0.24, 0, 0.22});
  machines::add_joint(scene, "hinge", JointType::revolute, ground, wheel, {0.24, 0, 0.22}, {0, 1, 0});
  scene.mbd->joints[0].damping = 1;
  AtRest machine(scene);
  EXPECT_LT(machine.report.distance, 1e-7);
  EXPECT_EQ(machine.modes.neutral, 1);
  ASSERT_EQ(machine.modes.modes.size(), 1U);
  compare("decay of its rate [1/s]", -machine.modes.modes[0].s.real(), 1 / 1.2, 1e-9);
}

TEST(Equilibrium, AMachineThatNothingHoldsIsRefused) {
  try {
    AtRest machine(machines::free_body(1, {1, 1, 1}, {0, 0, -g}));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_NE(std::string(error.what()).find("moves away"), std::string::npos) << error.what();
  }
}

}  // namespace modes_test
}  // namespace tandem::mbd
