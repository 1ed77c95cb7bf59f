// The six impact tests of [Chung2011], with every variant that they apply to. Tolerances: 0.5 % for closed
// forms, 1e-3 for the restitution, 2.5 % for digitised figures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"
#include "tests/verification/dem/impact.hpp"

namespace tandem::test {
namespace chung_ooi_test {

class Impact : public testing::TestWithParam<Variant> {};
const auto name_of = [](const auto& v) { return std::string(v.param.name); };
INSTANTIATE_TEST_SUITE_P(Variants, Impact, testing::ValuesIn(contact_variants()), name_of);
INSTANTIATE_TEST_SUITE_P(MoreLaws, Impact, testing::ValuesIn(more_laws()), name_of);

constexpr double closed_form = 5e-3, digitised = 0.025;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

std::string text(const char* format, double a, double b = 0) {
  char result[80];
  std::snprintf(result, sizeof result, format, a, b);
  return result;
}

TEST_P(Impact, Test1TwoEqualSpheres) {
  if (GetParam().hooke()) GTEST_SKIP() << "not Hertz's force";
  const Ball ball{4.8e10, 0.20, 2800, 1, 0.35, 0.01};
  const double R = ball.radius, v = 10, k = ball.stiffness_of_pair(), reduced = ball.mass() / 2;
  ParticleRun run(impact_scene(GetParam(), ball, 2, ""), tested_backend(), 1, [&](particles::Spheres& s) {
    s.position = {{-R, 0, 0}, {R, 0, 0}};
    s.velocity = {{v, 0, 0}, {-v, 0, 0}};
  });
  const double deepest = std::pow(1.25 * reduced * 4 * v * v / k, 0.4);
  const double force = k * std::pow(deepest, 1.5), duration = 2.9432 * deepest / (2 * v);
  const double dt = duration / 4000;
  double largest_force = 0, end = 0, before = v, overlap_ratio = 0;
  for (int s = 1; end == 0 && s < 8000; ++s) {
    overlap_ratio = static_cast<double>(run.advance(1, dt).window.max_overlap_ratio);
    const particles::Spheres now = run.state();
    largest_force = std::max(largest_force, ball.mass() * (before - now.velocity[0].x) / dt);
    before = now.velocity[0].x;
    if (now.position[1].x - now.position[0].x > 2 * R) end = s * dt;
  }
  expect_row(GetParam(), "largest force [N]", largest_force, force, closed_form);
  expect_row(GetParam(), "largest force, as published [N]", largest_force, 10697, closed_form);
  expect_row(GetParam(), "largest overlap, as published [m]", overlap_ratio * R, 274.1e-6, closed_form);
  expect_row(GetParam(), "duration, as published [s]", end, 40.34e-6, closed_form);
  expect_row(GetParam(), "speed after [m/s]", run.state().velocity[1].x, v, 1e-5);
}

TEST_P(Impact, Test2SphereOnRigidPlane) {
  if (GetParam().hooke()) GTEST_SKIP() << "not Hertz's force";
  const Ball ball{7e10, 0.30, 2699, 1, 0, 0.1};
  const Rebound r = impact_on_plane(GetParam(), ball, {0, 0, -0.2}, {});
  expect_row(GetParam(), "largest force, as published [N]", r.force, 11370, closed_form);
  expect_row(GetParam(), "largest overlap, as published [m]", r.deepest, 49.72e-6, closed_form);
  expect_row(GetParam(), "duration, as published [s]", r.duration, 731.6e-6, closed_form);
  expect_row(GetParam(), "speed after [m/s]", r.velocity.z, 0.2, 1e-5);
}

// Test 2 with the closed form of a linear spring.
TEST(Hooke, SphereOnRigidPlane) {
  const Ball ball{7e10, 0.30, 2699, 1, 0, 0.1};
  const double v = 0.2, m = ball.mass(), k = ball.spring();
  for (const Variant& variant : {Variant{"hooke", "hooke", "", true},
                                 Variant{"hooke_double", "hooke", R"("precision": "double",)", true}}) {
    const Rebound r = impact_on_plane(variant, ball, {0, 0, -v}, {});
    expect_row(variant, "largest force [N]", r.force, v * std::sqrt(m * k), closed_form);
    expect_row(variant, "largest overlap [m]", r.deepest, v * std::sqrt(m / k), closed_form);
    expect_row(variant, "duration [s]", r.duration, std::numbers::pi * std::sqrt(m / k), closed_form);
    expect_row(variant, "speed after [m/s]", r.velocity.z, v, 1e-5);
  }
}

TEST_P(Impact, Test3Restitution) {
  for (const double v : {0.1, 3.9})
    for (const double e : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
      const double back =
          impact_on_plane(GetParam(), {3.8e11, 0.23, 4000, e, 0, 0.0025}, {0, 0, -v}, {}).velocity.z;
      std::printf("  %-4s %-18s e = %.1f at %.1f m/s: measured %.6f tolerance 1e-3\n", tested_backend_name(),
                  GetParam().name, e, v, back / v);
      EXPECT_NEAR(back / v, e, 1e-3);
    }
}

Ball oxide() {
  return {3.8e11, 0.23, 4000, 0.98, 0.092, 0.0025};
}

// Gross sliding: Coulomb's limit acts throughout, and the plane takes mu (1 + e) m v_n of the tangential
// momentum.
TEST_P(Impact, Test4SlidingFollowsCoulomb) {
  if (!GetParam().friction) GTEST_SKIP() << "no friction";
  const Ball ball = oxide();
  const double v = 3.9, gain = ball.friction * (1 + ball.restitution);
  for (const double degrees : {40., 45., 50., 55., 60., 65., 70., 75., 80., 85.}) {
    const double v_n = v * std::cos(radians(degrees)), v_t = v * std::sin(radians(degrees));
    const Rebound r = impact_on_plane(GetParam(), ball, {v_t, 0, -v_n}, {});
    expect_row(GetParam(), text("e_t at %.0f degrees", degrees), r.velocity.x / v_t,
               1 - gain / std::tan(radians(degrees)), closed_form);
    expect_row(GetParam(), text("spin at %.0f degrees [rad/s]", degrees), r.spin.y,
               2.5 * gain * v_n / ball.radius, closed_form);
  }
}

// A second implementation of the law of dem_server/laws/hertz.hpp, for motion in a plane, with steps a tenth
// as long. It is the reference where no closed form exists.
Rebound mindlin_on_its_own(const Ball& ball, double v_t, double v_n) {
  const double nu = ball.poisson, e_star = ball.young / (1 - nu * nu);
  const double g_star = ball.young / (2 * (1 + nu)) / (2 - nu), R = ball.radius, m = ball.mass();
  const double l = std::log(ball.restitution);
  const double alpha = -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
  const double k_n = 4.0 / 3 * e_star * std::sqrt(R), k_t = 8 * g_star * std::sqrt(R);
  const double c_n = alpha * std::sqrt(m * k_n), c_t = alpha * std::sqrt(2.0 / 3 * m * k_t);
  const double dt = ball.duration_on_plane(v_n) / 40000;
  double depth = 0, sink = v_n, v = v_t, spin = 0, spring = 0;
  while (true) {
    const double before = depth;
    depth += dt * sink;
    if (depth <= 0) break;
    const double root = std::sqrt(depth), arm = R - depth, slip = v - arm * spin;
    if (depth > before) spring *= std::sqrt(before / depth);
    spring += dt * slip;
    const double elastic = k_n * depth * root, limit = ball.friction * elastic;
    const double stiffness = k_t * root;
    double force = stiffness * spring + c_t * std::sqrt(root) * slip;
    if (std::abs(force) > limit) {
      force = std::copysign(limit, force);
      if (stiffness * std::abs(spring) > limit) spring = std::copysign(limit / stiffness, spring);
    }
    sink -= dt / m * (elastic + c_n * std::sqrt(root) * sink);
    v -= dt / m * force;
    spin += dt * arm * force / (0.4 * m * R * R);
  }
  return {{v, 0, -sink}, {0, spin, 0}};
}

// Test 4 at angles where the contact sticks for a while. The row at 10 degrees is printed, but not compared
// with the digitised figures, which differ by 5 % among each other there: the law of the literature gives a
// spin 8.4 % below the digitised one for any step, and the exact solution of the half-space is 15 % above it
// (docs/contact_laws.md).
TEST_P(Impact, Test4Sticking) {
  if (!GetParam().mindlin()) GTEST_SKIP() << "other tangential force";
  const Ball ball = oxide();
  const double rows[][4] = {{10, 0.687, 213, -1.56}, {20, 0.616, 511, -7.54}, {30, 0.684, 617, -3.55}};
  for (const auto& [degrees, e_t, spin, angle] : rows) {
    const double v_t = 3.9 * std::sin(radians(degrees)), v_n = 3.9 * std::cos(radians(degrees));
    const Rebound r = impact_on_plane(GetParam(), ball, {v_t, 0, -v_n}, {}),
                  law = mindlin_on_its_own(ball, v_t, v_n);
    const double patch = r.velocity.x - ball.radius * r.spin.y;
    std::printf(
        "  %-4s %-18s %.0f degrees: e_t %.4f (digitised %.3f), spin %.1f (%.0f, %+.1f %%), patch at %.2f "
        "(%.2f) degrees\n",
        tested_backend_name(), GetParam().name, degrees, r.velocity.x / v_t, e_t, r.spin.y, spin,
        100 * (r.spin.y / spin - 1), std::atan2(patch, r.velocity.z) * 180 / std::numbers::pi, angle);
    if (degrees > 10) {
      expect_row(GetParam(), text("e_t at %.0f degrees, digitised", degrees), r.velocity.x / v_t, e_t,
                 digitised);
      expect_row(GetParam(), text("spin at %.0f degrees, digitised [rad/s]", degrees), r.spin.y, spin,
                 digitised);
    }
    expect_row(GetParam(), text("spin at %.0f degrees, the law alone [rad/s]", degrees), r.spin.y, law.spin.y,
               closed_form);
  }
}

// Close to the normal direction the dashpot exceeds Coulomb's limit when the contact begins. The surface must
// nevertheless not return faster than it came.
TEST_P(Impact, NearTheNormalTheSurfaceReturnsNoFaster) {
  if (!GetParam().mindlin()) GTEST_SKIP() << "other tangential force";
  for (const double e : {0.3, 0.98, 1.0})
    for (const double degrees : {1.0, 3.0, 6.0}) {
      Ball ball = oxide();
      ball.restitution = e;
      const double v_t = 3.9 * std::sin(radians(degrees)), v_n = 3.9 * std::cos(radians(degrees));
      const Rebound r = impact_on_plane(GetParam(), ball, {v_t, 0, -v_n}, {});
      const double back = (ball.radius * r.spin.y - r.velocity.x) / v_t;
      std::printf("  %-4s %-18s e = %.2f at %.0f degrees: tangential restitution of the surface %.4f\n",
                  tested_backend_name(), GetParam().name, e, degrees, back);
      EXPECT_LT(back, 1);
      EXPECT_GT(back, -1);
    }
}

// Test 5: constant normal speed. Gross sliding begins near psi = 5, where psi = kappa v_t / (mu v_n) and
// kappa = 2 (1 - nu) / (2 - nu). The tangential momentum is that of a rigid impact. The spin is less than
// 5 mu v_n / R, since conservation of angular momentum makes the lever arm R - delta. The mean of delta is
//   integral(F delta) / integral(F) = 0.4 B(1.4, 0.5) / 0.8 delta_max = 0.8176 delta_max,
// and pi/4 delta_max for a linear spring.
TEST_P(Impact, Test5ConstantNormalSpeed) {
  if (!GetParam().friction) GTEST_SKIP() << "no friction";
  const double v_n = 5;
  for (const Ball& ball : {Ball{2.08e11, 0.30, 7850, 1, 0.3, 1e-5}, Ball{1e9, 0.40, 1400, 1, 0.3, 1e-5}}) {
    const char* const name = ball.young > 1e10 ? "steel" : "polyethylene";
    const double unit = ball.friction * v_n, kappa = 2 * (1 - ball.poisson) / (2 - ball.poisson);
    const double share = GetParam().hooke()
                             ? std::numbers::pi / 4 * v_n * std::sqrt(ball.mass() / ball.spring())
                             : 0.8176 * ball.deepest_on_plane(v_n);
    const double arm = 1 - share / ball.radius;
    const auto what = [&](const char* of, double psi) { return std::string(name) + ", " + text(of, psi); };
    for (const double psi : {5.0, 6.0, 8.0, 12.0, 20.0}) {
      const double v_t = psi / kappa * unit;
      const Rebound r = impact_on_plane(GetParam(), ball, {v_t, 0, -v_n}, {});
      const double spin = r.spin.y * ball.radius / unit;
      expect_row(GetParam(), what("(v_t - v_t')/(mu v_n) at psi %.0f", psi), (v_t - r.velocity.x) / unit, 2,
                 closed_form);
      expect_row(GetParam(), what("R w'/(mu v_n) at psi %.0f", psi), spin, 5 * arm, closed_form);
      expect_row(GetParam(), what("R w'/(mu v_n) at psi %.0f, rigid", psi), spin, 5, digitised);
    }
    // The overlap of a slower sphere is a fortieth of that, so that its spin is that of a rigid sphere.
    const double slow = 1e-2 * v_n;
    for (const double psi : {5.0, 12.0}) {
      const double v_t = psi / kappa * ball.friction * slow;
      const Rebound r = impact_on_plane(GetParam(), ball, {v_t, 0, -slow}, {});
      expect_row(GetParam(), what("R w'/(mu v_n) at psi %.0f, slow, rigid", psi),
                 r.spin.y * ball.radius / (ball.friction * slow), 5, closed_form);
    }
    if (!GetParam().mindlin()) continue;
    for (const double psi : {1.0, 2.0, 2.99}) {
      const double v_t = psi / kappa * unit;
      const Rebound r = impact_on_plane(GetParam(), ball, {v_t, 0, -v_n}, {}),
                    law = mindlin_on_its_own(ball, v_t, v_n);
      expect_row(GetParam(), what("R w'/(mu v_n) at psi %.2f, the law alone", psi),
                 r.spin.y * ball.radius / unit, law.spin.y * ball.radius / unit, closed_form);
    }
  }
}

// Test 6: a spinning sphere that falls in the normal direction. beta is the tangential restitution of the
// contact point.
TEST_P(Impact, Test6SpinningSphere) {
  // The law `paper` limits friction by the whole normal force; the impulse of its repulsive part is 3.4 %
  // more than (1 + e) m v_n.
  if (!GetParam().mindlin() && !GetParam().hooke()) GTEST_SKIP() << "another limit of friction, or none";
  const Ball ball{7e10, 0.33, 2700, 0.5, 0.4, 0.1};
  const double v_n = 0.2, R = ball.radius;
  for (const double x : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    const double v_t = 3.5 * ball.friction * (1 + ball.restitution) * v_n / x;
    // The dashpot of `hooke` starts with a jump of the force, so that the error is of first order in the
    // step.
    const Rebound r = impact_on_plane(GetParam(), ball, {0, 0, -v_n}, {0, v_t / R, 0}, 10000);
    const double after = r.spin.y * R - r.velocity.x;
    expect_row(GetParam(), text("beta at x = %.2f", x), -after / v_t, x - 1, closed_form);
  }
}

}  // namespace chung_ooi_test
}  // namespace tandem::test
