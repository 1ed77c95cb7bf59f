// A01: the simple pendulum in joint coordinates against its closed form
//   sin(phi/2) = sin(pi/4) cd(sqrt(g) t, k = sin(pi/4)), x = -sin phi, y = -cos phi   (phi from the
//   vertical).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace pendulum_test {

constexpr double g = 9.81;

struct Exact {
  double t, x, y;
};
constexpr Exact exact[] = {{1, 0.986291751131875, -0.165010853125541},
                           {5, -0.942305435043758, -0.334754338414001},
                           {10, -0.275087462576117, -0.961419205099125}};

// Speed from the energy: v^2 = -2 g y; its direction is that of the circle.
double speed(double y) {
  return std::sqrt(-2 * g * y);
}

TEST(Pendulum, ConvergesToTheClosedFormWithOrderTwo) {
  for (const Exact& e : exact) {
    OrderTable table("A01 at t = " + std::to_string(int(e.t)) + " s, rho_inf = 0.9");
    for (int n = 1000; n <= 8000; n *= 2) {
      const double h = 1.0 / n;
      machines::Run run(machines::pendulum(), h);
      run.advance(static_cast<int>(e.t) * n);
      const Vector3d p = run.position(0);
      const double q_error = (p - Vector3d(e.x, e.y, 0)).norm();
      const double v_error = std::abs(run.velocity(0).norm() - speed(e.y));
      table.add(h, {q_error, v_error});
    }
    table.expect_order(2.0, 0.1);
  }
}

TEST(Pendulum, ReachesTheExactPositionsAtASmallStep) {
  machines::Run run(machines::pendulum(), 1.0 / 131072);
  for (int t = 1; t <= 10; ++t) {
    run.advance(131072);
    for (const Exact& e : exact) {
      if (int(e.t) != t) continue;
      const double error = (run.position(0) - Vector3d(e.x, e.y, 0)).norm();
      std::printf("A01 t = %2d s: x %.15f (exact %.15f), error %.2e, tolerance 1e-08\n", t,
                  run.position(0).x(), e.x, error);
      EXPECT_LT(error, 1e-8);
    }
  }
}

TEST(Pendulum, KeepsItsEnergy) {
  machines::Run run(machines::pendulum(), 10.0 / 4050);
  double worst = 0;
  for (int i = 0; i < 4050; ++i) {
    run.advance(1);
    const Vector3d p = run.position(0), v = run.velocity(0);
    worst = std::max(worst, std::abs(0.5 * v.squaredNorm() + g * p.y()));
  }
  std::printf("A01 energy error over 10 s with 4050 steps: %.3g J, limit 5e-05 J\n", worst);
  EXPECT_LT(worst, 5e-5);
}

}  // namespace pendulum_test
}  // namespace tandem::mbd
