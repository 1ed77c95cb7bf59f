// Rolling and twisting against closed forms, through the engine.
#include <gtest/gtest.h>

#include <cmath>

#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/rolling.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

constexpr double g = 9.81;

// A ball on a plane, tilted by rotating gravity; settled on its contact.
ContactScene ball(const char* what, double slope) {
  ContactScene scene;
  scene.young = 1e8;
  scene.dem = {{what, "elastic_plastic"}};
  scene.constants = {
      {"restitution", 0.3}, {"friction", 0.5}, {"rolling_friction", 0.1}, {"rolling_damping", 0.3}};
  scene.gravity = {g * std::sin(slope), 0, -g * std::cos(slope)};
  return scene;
}
double settled(const ContactScene& scene) {
  return scene.radius - std::pow(scene.mass() * -scene.gravity.z / scene.hertz(), 2.0 / 3);
}

// Rolling without slip, m and 2/5 m R^2 against mu_r R F: v' = g sin - mu_r g cos, times 5/7.
TEST(Rolling, SlowsDownByFiveSeventhsOfItsCoefficient) {
  const ContactScene scene = ball("rolling", 0);
  const double v = 0.5, dt = 1e-5;
  ParticleRun run = scene.run(settled(scene), {v, 0, 0}, {0, v / scene.radius, 0});
  // The dashpot acts until the spring has reached its limit, which is before the measurement.
  for (int w = 0; w < 5; ++w) run.advance(200, dt);
  const double before = run.state().velocity[0].x;
  for (int w = 0; w < 50; ++w) run.advance(200, dt);
  expect_close("speed lost [m/s]", before - run.state().velocity[0].x, 5.0 / 7 * 0.1 * g * 0.1, 5e-3);
  const dem::WindowOutcome& o = run.advance(10, dt);
  // The plane receives the reaction of the moment about the contact, in addition to that of the forces.
  const Vec3d x = run.state().position[0];
  const Wrench& load = o.load.back();
  const Vec3d of_force = cross(Vec3d{x.x, x.y, 0}, load.force);
  expect_close("moment on the plane [N m]", load.torque.y - of_force.y, 0.1 * scene.radius * scene.mass() * g,
               5e-3);
}

TEST(Rolling, HoldsOnASlopeBelowItsCoefficientAndRollsAbove) {
  for (const double slope : {0.09, 0.12}) {
    const ContactScene scene = ball("rolling", std::atan(slope));
    ParticleRun run = scene.run(settled(scene), {});
    const double dt = 1e-5;
    // Until its oscillation on the spring has decayed.
    for (int w = 0; w < 100; ++w) run.advance(300, dt);
    const double before = run.state().velocity[0].x;
    for (int w = 0; w < 50; ++w) run.advance(300, dt);
    const double a = (run.state().velocity[0].x - before) / 0.15;
    std::printf("  slope %.2f: acceleration %.6f m/s2\n", slope, a);
    if (slope < 0.1)
      EXPECT_LT(std::abs(a), 1e-6 * g);
    else
      expect_close("acceleration [m/s2]", a, 5.0 / 7 * (scene.gravity.x + 0.1 * scene.gravity.z), 5e-3);
  }
}

// A ball oscillates within its contact. A spring that stiffens while it keeps its moment would convert this
// oscillation into endless rolling.
TEST(Rolling, TakesNoEnergyFromTheSwingAcrossIt) {
  ContactScene scene = ball("rolling", 0);
  scene.constants = {{"restitution", 1}, {"friction", 5}, {"rolling_friction", 0.54}, {"rolling_damping", 0}};
  const double height = scene.radius - (scene.radius - settled(scene)) / 2, dt = 1e-5;
  ParticleRun run = scene.run(height, {1e-7, 0, 0});
  double first = 0, last = 0;
  for (int w = 0; w < 1000; ++w) {
    run.advance(200, dt);
    const double spin = norm(run.state().spin[0]);
    if (w < 20) first = std::max(first, spin);
    if (w >= 900) last = std::max(last, spin);
  }
  std::printf("  largest spin in the first 40 ms %.2e rad/s, from 1.8 to 2 s %.2e rad/s\n", first, last);
  EXPECT_GT(first, 1e-6);
  EXPECT_LT(last, first / 10);
}

// With very large damping, and with very long steps.
TEST(Rolling, ADozenDashpotsDoNotStopASphereTwiceInAStep) {
  const double radius = 0.01, mass = 0.01, about_centre = 0.4 * mass * radius * radius;
  dem::Contact<double> c;
  c.n = {0, 0, 1};
  c.r_eff = radius;
  dem::ContactForce<double> f;
  f.k_n = 1e6;
  f.elastic_force = 1e6;
  for (const double dt : {1e-9, 1e-6, 1e-3}) {
    c.dt = dt;
    Vec3d rolled;
    const Vec3d moment = dem::RollingResistance{}(c, f, {0, 1e-12, 0}, {1, 1}, 3.5 * about_centre, rolled);
    const double of_spring = -2.25 * f.k_n * radius * radius * rolled.y;
    const double share = (of_spring - moment.y) * dt / (about_centre * 1e-12);
    std::printf("  step %.0e s: one contact takes %.3g of the spin\n", dt, share);
    EXPECT_LE(share, 1.0 / 6 + 1e-6);
    EXPECT_GT(share, 0);
  }
}

// Squares of their moments are beyond the range of single precision.
TEST(Rolling, LimitHoldsForSpheresHoweverSmall) {
  for (const double radius : {1e-8, 1e-7, 1e-6, 1e-3, 1.0}) {
    dem::Contact<float> c;
    c.n = {0, 0, 1};
    c.r_eff = static_cast<float>(radius);
    c.dt = 1e-6F;
    dem::ContactForce<float> f;
    f.k_n = static_cast<float>(1e6 * radius);
    f.elastic_force = static_cast<float>(1e-3 * 1e6 * radius * radius);
    Vec3f rolled{0, 1, 0};
    const dem::RollingConstants<float> k{0.01F, 0};
    const Vec3f moment = dem::RollingResistance{}(c, f, {}, k, 1.0F, rolled);
    expect_close("moment [N m]", static_cast<double>(-moment.y), 0.01 * radius * 1e-3 * 1e6 * radius * radius,
                 1e-6);
  }
}

// The contact slides as a whole: I w' = -2/3 a mu m g.
TEST(Twisting, SpinFallsByTheMomentOfTheContactArea) {
  const ContactScene scene = ball("twisting", 0);
  const double height = settled(scene), a = std::sqrt(scene.radius * (scene.radius - height)), w0 = 20,
               dt = 2e-6;
  ParticleRun run = scene.run(height, {}, {0, 0, w0});
  for (int w = 0; w < 20; ++w) run.advance(1000, dt);
  const double moment = 2.0 / 3 * a * 0.5 * scene.mass() * g;
  expect_close("spin lost [rad/s]", w0 - run.state().spin[0].z, moment * 0.04 / scene.moment(), 2e-3);
  expect_close("moment on the plane [N m]", run.advance(1, dt).load.back().torque.z, moment, 2e-3);
}

// Below the limit it oscillates on k_t a^2 / 2 with k_t = 8 G* a.
TEST(Twisting, SmallTurnsSwingOnMindlinsSprings) {
  ContactScene scene = ball("twisting", 0);
  scene.constants["restitution"] = 1;
  scene.constants["friction"] = 100;
  const double height = settled(scene), a = std::sqrt(scene.radius * (scene.radius - height)), dt = 2e-7;
  const double shear = scene.young / (2 * (1 + scene.poisson)), g_star = shear / (2 * (2 - scene.poisson));
  const double omega = std::sqrt(8 * g_star * a * a * a / 2 / scene.moment());
  ParticleRun run = scene.run(height, {}, {0, 0, 1e-3});
  double crossed = 0, before = 1e-3;
  for (int step = 1; crossed == 0 && step < 200000; ++step) {
    run.advance(5, dt);
    const double now = run.state().spin[0].z;
    if (before > 0 && now <= 0) crossed = 5 * dt * (step - now / (now - before));
    before = now;
  }
  expect_close("quarter of a period [s]", crossed, std::numbers::pi / 2 / omega, 2e-3);
}

}  // namespace
}  // namespace tandem::test
