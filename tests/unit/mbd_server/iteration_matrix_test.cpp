// Analytic derivatives against central differences of the residual, on a machine that has every kind of part.
#include <gtest/gtest.h>

#include <random>

#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

struct Differences : ::testing::Test {
  scene::Scene scene = machines::menagerie();
  Model model = build_model(scene);
  TreeSystem system{model};
  TreeDynamics dynamics{model};
  State state = initial_state(model, scene);
  VectorXd x0 = VectorXd::Zero(model.freedoms);
  std::mt19937 random{7};

  VectorXd any(double size) {
    std::uniform_real_distribution<double> d(-size, size);
    return VectorXd::NullaryExpr(model.freedoms, [&] { return d(random); });
  }
  void SetUp() override {
    const VectorXd q0 = state.q;
    system.move(q0, any(.5), state.q);
    state.u += any(2);
    state.udot = any(5);
    state.time = .37;
    for (Eigen::Index i = 0; i < state.loads.size(); ++i)
      state.loads.data()[i] = 3 * std::sin(1.0 + 2.0 * double(i));
  }

  Eigen::MatrixXd analytic(const MatrixWeights& weights, const VectorXd& x) {
    Eigen::MatrixXd A;
    dynamics.residual(state);
    dynamics.matrix(weights, x, A);
    return A;
  }
  // Columns (r(+e) - r(-e)) / 2 e for a change that `change` makes to a copy of the state.
  template <class Change>
  Eigen::MatrixXd differences(const Change& change) {
    Eigen::MatrixXd A(model.freedoms, model.freedoms);
    const double e = 1e-6;
    for (int j = 0; j < model.freedoms; ++j) {
      State plus = state, minus = state;
      change(plus, j, e);
      change(minus, j, -e);
      const VectorXd up = dynamics.residual(plus), down = dynamics.residual(minus);
      A.col(j) = (up - down) / (2 * e);
    }
    return A;
  }
  void expect_close(const char* what, const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    const double error = (A - B).cwiseAbs().maxCoeff() / B.cwiseAbs().maxCoeff();
    std::printf("%-28s size %ld  largest entry %9.3g  relative error %8.1e  tolerance 1e-08\n", what,
                long(A.rows()), B.cwiseAbs().maxCoeff(), error);
    EXPECT_LT(error, 1e-8);
  }
};

TEST_F(Differences, Mass) {
  expect_close("dr/du'", analytic({1, 0, 0}, x0),
               differences([](State& s, int j, double e) { s.udot[j] += e; }));
}

TEST_F(Differences, Damping) {
  expect_close("dr/du", analytic({0, 1, 0}, x0), differences([](State& s, int j, double e) { s.u[j] += e; }));
}

TEST_F(Differences, Stiffness) {
  expect_close("dr/dx at x = 0", analytic({0, 0, 1}, x0), differences([&](State& s, int j, double e) {
                 VectorXd x = VectorXd::Zero(model.freedoms);
                 x[j] = e;
                 const VectorXd q = s.q;
                 system.move(q, x, s.q);
               }));
}

TEST_F(Differences, StiffnessAfterALargeIncrement) {
  const VectorXd q0 = state.q, x1 = any(.8);
  system.move(q0, x1, state.q);
  expect_close("dr/dx at x != 0", analytic({0, 0, 1}, x1), differences([&](State& s, int j, double e) {
                 VectorXd x = x1;
                 x[j] += e;
                 system.move(q0, x, s.q);
               }));
}

TEST_F(Differences, WeightedSum) {
  const Eigen::MatrixXd sum =
      3 * analytic({1, 0, 0}, x0) + 5 * analytic({0, 1, 0}, x0) + 7 * analytic({0, 0, 1}, x0);
  EXPECT_LT((analytic({3, 5, 7}, x0) - sum).cwiseAbs().maxCoeff(), 1e-12 * sum.cwiseAbs().maxCoeff());
}

TEST_F(Differences, MassMatrixIsSymmetricAndPositive) {
  const Eigen::MatrixXd M = analytic({1, 0, 0}, x0);
  EXPECT_LT((M - M.transpose()).cwiseAbs().maxCoeff(), 1e-13 * M.cwiseAbs().maxCoeff());
  EXPECT_EQ(M.llt().info(), Eigen::Success);
}

// A system that is found to have no velocity terms must really have none.
TEST(GyroscopicTerms, AreLeftOutOnlyWhereTheyVanish) {
  scene::Scene pendulum = machines::pendulum();
  EXPECT_FALSE(build_model(pendulum).gyroscopic);
  EXPECT_TRUE(build_model(machines::heavy_top()).gyroscopic);
  EXPECT_TRUE(build_model(machines::free_body(1, {1, 2, 3}, {0, 0, 0})).gyroscopic);
  const BodyId second = machines::add_body(pendulum, "second", 1, {0, 0, 0}, {-2, 0, 0});
  machines::add_joint(pendulum, "pin2", scene::JointType::revolute, BodyId{0}, second, {-1, 0, 0});
  EXPECT_TRUE(build_model(pendulum).gyroscopic);
  scene::Scene table = machines::empty();
  const BodyId x = machines::add_body(table, "x", 1, {1, 1, 1}, {0, 0, 0});
  const BodyId y = machines::add_body(table, "y", 1, {1, 1, 1}, {0, 0, 0});
  machines::add_joint(table, "jx", scene::JointType::prismatic, ground, x, {0, 0, 0}, {1, 0, 0});
  machines::add_joint(table, "jy", scene::JointType::prismatic, x, y, {0, 0, 0}, {0, 1, 0});
  EXPECT_FALSE(build_model(table).gyroscopic);
}

}  // namespace
}  // namespace tandem::mbd
