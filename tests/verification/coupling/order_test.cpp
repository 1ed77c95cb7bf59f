// Order in the window H on the two-mass oscillator of the literature, through the coordinator and its
// channels. The body has the mass m1 on the spring c1; the bed, with m2 on c2, pushes it by ck and dk:
//   m1 x1'' + c1 x1 = F,  m2 x2'' + c2 x2 = -F,  F = ck (x2 - x1) + dk (v2 - v1).
// Closed form by eigenvectors. Values of preCICE's public test case: m = 1, 1; c1, ck, c2 = 4, 16, 4 pi^2.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>

#include "tests/doubles/coupled_oscillator.hpp"

namespace tandem::test {
namespace order_test {

using scene::LoadShape;
using scene::PathShape;
using scene::Scheme;

constexpr double c1 = 4 * M_PI * M_PI, ck = 16 * M_PI * M_PI, c2 = 4 * M_PI * M_PI;

// x1, v1, x2, v2 at the time t, from x1 = 1 at rest.
Eigen::Vector4d exact(double dk, double t) {
  Eigen::Matrix4d A;
  A << 0, 1, 0, 0,            //
      -c1 - ck, -dk, ck, dk,  //
      0, 0, 0, 1,             //
      ck, dk, -c2 - ck, -dk;
  const Eigen::EigenSolver<Eigen::Matrix4d> solver(A);
  const Eigen::Vector4cd modes = solver.eigenvectors().partialPivLu().solve(Eigen::Vector4cd(1, 0, 0, 0));
  const Eigen::Vector4cd factors = (solver.eigenvalues() * t).array().exp().matrix().cwiseProduct(modes);
  return (solver.eigenvectors() * factors).real();
}

struct Result {
  double error;   // of positions and velocities, relative to what they reach [-]
  double energy;  // created by the coupling over the energy that was there [-]
};

Result run(const scene::Coupling& how, double dk, int windows) {
  const double t = 1;
  CoupledOscillator oscillator({1, c1, 0}, {1, ck, dk, c2, 0}, how);
  oscillator.body.x = 1;
  for (int i = 0; i < windows; ++i) oscillator.advance(t / windows);
  const Eigen::Vector4d e = exact(dk, t);
  const double scale = std::sqrt(c1 + ck);
  const Eigen::Vector4d difference(oscillator.body.x - e[0], (oscillator.body.v - e[1]) / scale,
                                   oscillator.bed.y - e[2], (oscillator.bed.w - e[3]) / scale);
  return {difference.norm(), std::abs(oscillator.coupler().accounts().energy_created()) / ((c1 + ck) / 2)};
}

struct Case {
  const char* name;
  Scheme scheme;
  LoadShape load;
  PathShape path;
  double dk;            // [N s/m]
  double order;         // of the error, and of the energy residual over the run
  double energy_order;  // 0: no energy is created
  // Coarsest run. Like its halves, a window is a whole number of nanoseconds.
  int windows = 500;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class Order : public testing::TestWithParam<Case> {};

TEST_P(Order, InTheWindow) {
  const Case& c = GetParam();
  scene::Coupling how;
  how.scheme = c.scheme;
  how.load = c.load;
  how.path = c.path;
  how.window = 1e6;
  if (c.scheme == Scheme::implicit)
    how.iteration = scene::Iteration{{.length = 1e-15, .max_iterations = 100, .tolerance = 1e-12}};
  const int first = c.windows;
  Result coarse = run(how, c.dk, first);
  for (const int windows : {2 * first}) {
    const Result fine = run(how, c.dk, windows);
    const double measured = std::log2(coarse.error / fine.error),
                 energy = std::log2(coarse.energy / fine.energy);
    std::printf(
        "  %-28s %4d windows: error %.3e, order: expected %.1f  measured %.3f  tolerance 0.1;  energy "
        "created "
        "%.3e, order: expected %.1f  measured %.3f\n",
        c.name, windows, fine.error, c.order, measured, fine.energy, c.energy_order, energy);
    EXPECT_NEAR(measured, c.order, 0.1);
    if (c.energy_order > 0)
      EXPECT_NEAR(energy, c.energy_order, 0.2);
    else
      EXPECT_LT(fine.energy, 1e-8) << "nothing is created, but for the tolerance of the iteration";
    coarse = fine;
  }
}

constexpr double damping = 2;  // [N s/m]
INSTANTIATE_TEST_SUITE_P(
    TwoMassOscillator, Order,
    testing::Values(
        Case{"parallel", Scheme::parallel, LoadShape::mean, PathShape::linear, damping, 1, 1},
        Case{"parallel_end", Scheme::parallel, LoadShape::end, PathShape::linear, damping, 1, 1},
        Case{"mbd_first", Scheme::mbd_first, LoadShape::mean, PathShape::linear, damping, 1, 1},
        Case{"mbd_first_end", Scheme::mbd_first, LoadShape::end, PathShape::linear, damping, 1, 1},
        Case{"mbd_first_undamped", Scheme::mbd_first, LoadShape::mean, PathShape::linear, 0, 1, 1},
        Case{"dem_first", Scheme::dem_first, LoadShape::mean, PathShape::linear, damping, 1, 2},
        Case{"dem_first_end", Scheme::dem_first, LoadShape::end, PathShape::linear, damping, 1, 1},
        Case{"dem_first_undamped", Scheme::dem_first, LoadShape::mean, PathShape::linear, 0, 2, 3},
        Case{"dem_first_second_order", Scheme::dem_first, LoadShape::linear, PathShape::quadratic, damping, 2,
             3},
        Case{"dem_first_second_order_undamped", Scheme::dem_first, LoadShape::linear, PathShape::quadratic, 0,
             3, 3},
        // Its second-order part is large: the slope is 1.11 from 500 to 1,000 windows and falls to 1 from
        // there.
        Case{"linear_implicit", Scheme::linear_implicit, LoadShape::mean, PathShape::linear, damping, 1, 2,
             1000},
        Case{"implicit", Scheme::implicit, LoadShape::mean, PathShape::linear, damping, 2, 0},
        Case{"implicit_linear", Scheme::implicit, LoadShape::linear, PathShape::linear, damping, 4, 4}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace order_test
}  // namespace tandem::test
