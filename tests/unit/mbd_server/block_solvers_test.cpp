// Conjugate gradients and the factorisation by blocks, of matrices as contacts between bodies have.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "common/error.hpp"
#include "mbd_server/time_stepping/block_cholesky.hpp"
#include "mbd_server/time_stepping/conjugate_gradients.hpp"

namespace tandem::mbd {
namespace {

// Rows of bodies of mass 1 in contact with their neighbours: each contact adds its stiffness times J^T J.
BlockMatrix contacts(int width, int height, double stiffness) {
  std::mt19937 random(3);
  const auto chance = [&] { return static_cast<double>(random()) / 2147483648. - 1; };
  BlockMatrix A;
  A.diagonal.assign(as_index(width * height), Matrix6d::Identity());
  const auto couple = [&](int a, int b) {
    Eigen::Matrix<double, 3, 6> J_a, J_b;
    for (auto& x : J_a.reshaped()) x = chance();
    for (auto& x : J_b.reshaped()) x = chance();
    A.diagonal[as_index(a)] += stiffness * J_a.transpose() * J_a;
    A.diagonal[as_index(b)] += stiffness * J_b.transpose() * J_b;
    A.pairs.emplace_back(a, b);
    A.upper.emplace_back(stiffness * J_a.transpose() * J_b);
  };
  for (int i = 0; i < width * height; ++i) {
    if (i % width + 1 < width) couple(i, i + 1);
    if (i + width < width * height) couple(i, i + width);
  }
  return A;
}

std::vector<Vector6d> right_side(const BlockMatrix& A) {
  std::vector<Vector6d> r;
  for (int i = 0; i < A.rows(); ++i) r.push_back(Vector6d::LinSpaced(6, std::sin(i), std::cos(3 * i)));
  return r;
}

VectorXd stacked(const std::vector<Vector6d>& x) {
  VectorXd all(6 * std::ssize(x));
  for (std::size_t i = 0; i < x.size(); ++i) all.segment<6>(6 * static_cast<Eigen::Index>(i)) = x[i];
  return all;
}

Eigen::MatrixXd dense(const BlockMatrix& A) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6 * A.rows(), 6 * A.rows());
  for (int i = 0; i < A.rows(); ++i) all.block<6, 6>(6 * i, 6 * i) = A.diagonal[as_index(i)];
  for (std::size_t k = 0; k < A.pairs.size(); ++k) {
    const auto [i, j] = A.pairs[k];
    all.block<6, 6>(6 * i, 6 * j) = A.upper[k];
    all.block<6, 6>(6 * j, 6 * i) = A.upper[k].transpose();
  }
  return all;
}

// Of x to the solution of the dense system, over its size.
double error_of(const BlockMatrix& A, const std::vector<Vector6d>& r, const std::vector<Vector6d>& x) {
  const VectorXd exact = dense(A).llt().solve(stacked(r));
  return (stacked(x) - exact).norm() / exact.norm();
}

TEST(BlockSolvers, TheProductIsThatOfTheDenseMatrix) {
  const BlockMatrix A = contacts(8, 6, 5);
  const std::vector<Vector6d> x = right_side(A);
  std::vector<Vector6d> y(x.size());
  A.multiply(x, y);
  const VectorXd exact = dense(A) * stacked(x);
  EXPECT_LT((stacked(y) - exact).norm(), 1e-13 * exact.norm());
}

TEST(BlockSolvers, BothSolveAsTheDenseFactorisation) {
  for (const double stiffness : {1., 20.}) {
    const BlockMatrix A = contacts(8, 6, stiffness);
    const std::vector<Vector6d> r = right_side(A);
    std::vector<Vector6d> x = r, y = r;
    BlockCholesky direct;
    direct.factorise(A);
    direct.solve(x);
    EXPECT_LT(error_of(A, r, x), 1e-12);
    ConjugateGradients iterative;
    ASSERT_TRUE(iterative.solve(A, 1e-12, y));
    EXPECT_LT(error_of(A, r, y), 1e-9);
    EXPECT_GT(iterative.iterations(), 3);
  }
}

// With a part that is not symmetric, as friction has that slides: u w^T of neighbours.
TEST(BlockSolvers, AMatrixThatIsNotSymmetricIsSolved) {
  const BlockMatrix A = contacts(8, 6, 5);
  const Vector6d u = Vector6d::LinSpaced(6, -1, 2), w = Vector6d::LinSpaced(6, 1, -0.5);
  const auto add = [&](const std::vector<Vector6d>& x, std::vector<Vector6d>& y) {
    for (std::size_t i = 1; i < x.size(); ++i) y[i] += w.dot(x[i - 1]) * u;
  };
  Eigen::MatrixXd all = dense(A);
  for (int i = 1; i < A.rows(); ++i) all.block<6, 6>(6 * i, 6 * i - 6) += u * w.transpose();
  const std::vector<Vector6d> r = right_side(A);
  std::vector<Vector6d> x = r;
  ConjugateGradients iterative;
  ASSERT_TRUE(iterative.solve(A, add, 1e-10, x));
  const VectorXd exact = all.partialPivLu().solve(stacked(r));
  EXPECT_LT((stacked(x) - exact).norm(), 1e-8 * exact.norm());
}

TEST(BlockSolvers, ThePreconditionerOfAChainIsExact) {
  const BlockMatrix A = contacts(40, 1, 1e4);
  std::vector<Vector6d> x = right_side(A);
  ConjugateGradients iterative;
  ASSERT_TRUE(iterative.solve(A, 1e-8, x));
  EXPECT_EQ(iterative.iterations(), 1);
  EXPECT_LT(error_of(A, right_side(A), x), 1e-8);
}

TEST(BlockSolvers, ConjugateGradientsGiveUpWhereTheMatrixIsStiff) {
  const BlockMatrix A = contacts(20, 20, 1e12);
  const std::vector<Vector6d> r = right_side(A);
  std::vector<Vector6d> x = r;
  ConjugateGradients iterative;
  EXPECT_FALSE(iterative.solve(A, 1e-12, x));
  EXPECT_EQ(stacked(x), stacked(r));
}

TEST(BlockSolvers, AMatrixThatIsNotPositiveDefiniteIsRefused) {
  BlockMatrix A = contacts(4, 4, 5);
  A.diagonal[7] -= 1e3 * Matrix6d::Identity();
  const std::vector<Vector6d> r = right_side(A);
  std::vector<Vector6d> x = r;
  ConjugateGradients iterative;
  EXPECT_FALSE(iterative.solve(A, 1e-6, x));
  EXPECT_EQ(stacked(x), stacked(r));
  BlockCholesky direct;
  EXPECT_THROW(direct.factorise(A), Error);
}

// The same solver after another pattern of blocks.
TEST(BlockSolvers, ThePlanFollowsTheBlocks) {
  BlockCholesky direct;
  for (const int width : {8, 5, 8}) {
    const BlockMatrix A = contacts(width, 6, 5);
    const std::vector<Vector6d> r = right_side(A);
    std::vector<Vector6d> x = r;
    direct.factorise(A);
    direct.solve(x);
    EXPECT_LT(error_of(A, r, x), 1e-12);
  }
}

}  // namespace
}  // namespace tandem::mbd
