// A free body: flips of an asymmetric one (Dzhanibekov), and the exact impulse of loads that jump.
#include <gtest/gtest.h>

#include <cmath>

#include "mbd_server/io/observation.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace free_body_test {

const Vec3d J{1, 2, 3};

struct Kept {
  double energy, momentum;  // largest relative error over the run
  int flips;                // of the rotation about the middle axis
};

Kept spin(double h, double seconds) {
  machines::Run run(machines::free_body(1, J, {0, 0, 0}), h);
  const Vector3d inertia = to_eigen(J), w0(1e-3, 6, 2e-3);
  run.restart([&](State& s) { s.u.tail<3>() = w0; });
  const double E0 = 0.5 * w0.dot(inertia.cwiseProduct(w0));
  const Vector3d L0 = inertia.cwiseProduct(w0);
  Kept kept{0, 0, 0};
  double last = w0.y();
  for (int i = 0; i < std::lround(seconds / h); ++i) {
    run.advance(1);
    run.system.residual(run.state);
    const Vector3d w = run.state.u.tail<3>();
    const Vector3d L = run.system.links().back().R_WL * inertia.cwiseProduct(w);
    kept.energy = std::max(kept.energy, std::abs(0.5 * w.dot(inertia.cwiseProduct(w)) / E0 - 1));
    kept.momentum = std::max(kept.momentum, (L - L0).norm() / L0.norm());
    if (last * w.y() < 0) ++kept.flips;
    last = w.y();
    EXPECT_NEAR(run.state.q.tail<4>().norm(), 1, 1e-14);
  }
  return kept;
}

TEST(FreeBody, FlipsAndKeepsEnergyAndAngularMomentum) {
  std::printf("Dzhanibekov, J = (1, 2, 3) kg m2, 6 rad/s about the middle axis, 20 s, rho_inf = 0.9\n");
  std::printf("%10s %14s %7s %14s %7s %6s\n", "h [s]", "energy error", "slope", "momentum error", "slope",
              "flips");
  Kept last{};
  for (const double h : {4e-3, 2e-3, 1e-3, 5e-4}) {
    const Kept kept = spin(h, 20);
    const double e = std::log2(last.energy / kept.energy), p = std::log2(last.momentum / kept.momentum);
    std::printf("%10.1e %14.3e %7s %14.3e %7s %6d\n", h, kept.energy,
                slope_text(last.energy, kept.energy).c_str(), kept.momentum,
                slope_text(last.momentum, kept.momentum).c_str(), kept.flips);
    EXPECT_GE(kept.flips, 4);
    if (last.energy > 0) {
      EXPECT_NEAR(e, 2, 0.1);
      EXPECT_NEAR(p, 2, 0.1);
    }
    last = kept;
  }
}

// v1 = v0 + H (F/m + g) and x1 = x0 + H v0 + H^2/2 (F/m + g), to round-off, although the load jumps at every
// window.
TEST(FreeBody, GainsExactlyTheImpulseOfLoadsThatJump) {
  const double mass = 3.7, H = 1e-3;
  const Vector3d gravity(0, 0, -9.81);
  for (const double rho : {0.0, 0.5, 0.8, 1.0}) {
    scene::Scene scene = machines::free_body(mass, {.1, .2, .3}, to_vec3(gravity));
    machines::add_wall(scene, BodyId{0});
    machines::Run run(scene, H / 4, rho);
    Vector3d x = Vector3d::Zero(), v = Vector3d::Zero(), impulse = Vector3d::Zero();
    for (int n = 0; n < 200; ++n) {
      const Vector3d F(50 * std::sin(1.0 + n), -80 * std::cos(3.0 * n), n % 3 == 0 ? 1e4 : -20);
      run.state.loads.col(0) = spatial(Vector3d::Zero(), F);
      run.integrator.jump(run.system, run.state);
      run.advance(4);
      x += H * v + 0.5 * H * H * (F / mass + gravity);
      v += H * (F / mass + gravity);
      impulse += H * F;
    }
    const double v_error = (run.velocity(0) - v).norm() / v.norm(),
                 x_error = (run.position(0) - x).norm() / x.norm();
    const Vector3d gained = mass * (run.velocity(0) - 200 * H * gravity);
    const double p_error = (gained - impulse).norm() / impulse.norm();
    std::printf("rho_inf %.1f, 200 jumps: relative error of v %.1e, x %.1e, impulse %.1e; tolerance 1e-12\n",
                rho, v_error, x_error, p_error);
    EXPECT_LT(v_error, 1e-12);
    EXPECT_LT(x_error, 1e-12);
    EXPECT_LT(p_error, 1e-12);
  }
}

}  // namespace free_body_test
}  // namespace tandem::mbd
