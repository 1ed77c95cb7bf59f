// Methods that find a fixed point x = g(x) where simple repetition of g converges slowly or not at all (a
// light body in heavy grains: |g'| is at least the ratio of the masses).
#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>

#include "common/scene/model.hpp"
#include "coordinator/schemes/archive.hpp"

namespace tandem::launch {

class Accelerator {
 public:
  virtual ~Accelerator() = default;
  // The next iterate, from the present one and its image.
  virtual Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& image) = 0;
  // An estimate of (1 - g')^-1, which replaces the relaxation until differences are known; empty: none.
  virtual void expect(const Eigen::MatrixXd&) {}
  // Ends the iteration of a window: the next one has another fixed point, of a similar function.
  virtual void end_window() = 0;
  // Saves or restores the state that is kept between two windows.
  virtual void save_or_restore(Archive& archive) = 0;
};

std::unique_ptr<Accelerator> make_accelerator(const scene::Iteration& how);

// x + w r with r = g(x) - x. Converges while |1 - w (1 - g')| < 1 for all eigenvalues g'.
class ConstantRelaxation final : public Accelerator {
 public:
  explicit ConstantRelaxation(double factor) : factor_(factor) {}
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& image) override;
  void end_window() override {}
  void save_or_restore(Archive&) override {}

 private:
  double factor_;
};

// The secant method in the direction of the residual (Kuettler and Wall, Comput. Mech. 43, 2008): w' = -w <r,
// r' - r> / |r' - r|^2. The factor of a window starts where the last one ended.
class Aitken final : public Accelerator {
 public:
  explicit Aitken(double first_factor) : factor_(first_factor) {}
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& image) override;
  void end_window() override { last_residual_.resize(0); }
  void save_or_restore(Archive& archive) override;

 private:
  double factor_;
  Eigen::VectorXd last_residual_;
};

// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe, Vierendeels, Comput.
// Struct. 87, 2009): differences of residuals and images of this window and of the last ones, newest first;
// columns that add nothing new are left out. Deviation from the paper: the part of the residual that the
// columns do not explain is relaxed like the first step, because a full step of a light body may take the
// particles out of the valid range of their contact law. Where the response of a liquid is known, its step
// takes the place of that relaxation.
class QuasiNewton final : public Accelerator {
 public:
  explicit QuasiNewton(double relaxation) : relaxation_(relaxation) {}
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& image) override;
  void expect(const Eigen::MatrixXd& inverse) override { expected_ = inverse; }
  void end_window() override;
  void save_or_restore(Archive& archive) override;

 private:
  struct Column {
    Eigen::VectorXd residual, iterate;  // differences of two evaluations
  };
  double relaxation_;
  Eigen::MatrixXd expected_;        // of this window
  std::deque<Column> columns_;      // newest first
  std::deque<std::size_t> counts_;  // columns of each window, newest window first
  std::size_t own_ = 0;             // columns of this window
  Eigen::VectorXd last_x_, last_residual_;
};

}  // namespace tandem::launch
