#include "common/scene/time_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

namespace tandem::scene {
namespace {

// True when 200 central-difference steps of x'' = -w2 x - 2 zeta sqrt(w2) x' stay bounded. The damping force
// uses the velocity of the half step before, as explicit DEM does.
bool stable(double step, double stiffness, double damping, double mass) {
  double x = 1, v = 0;
  for (int i = 0; i < 2000; ++i) {
    v += step * (-stiffness * x - damping * v) / mass;
    x += step * v;
    if (!(std::abs(x) < 1e3)) return false;
  }
  return true;
}

TEST(TimeStep, RayleighTimeOfGlass) {
  const Material glass{.name = "glass", .density = 2500, .young = 7e10, .poisson = 0.25};
  const double shear = 2.8e10;
  const double expected = std::numbers::pi * 0.01 * std::sqrt(2500 / shear) / (0.1631 * 0.25 + 0.8766);
  const double measured = rayleigh_time(0.01, glass);
  std::cout << "expected " << expected << " measured " << measured << " tolerance 1e-12 relative\n";
  EXPECT_NEAR(measured / expected, 1, 1e-12);
}

TEST(TimeStep, ContactTimeIsTheLimitOfStability) {
  const double radius = 0.01, mass = 0.005;
  for (const double damping : {0.0, 10.0, 100.0, 1000.0}) {
    const Pair pair{.a = {},
                    .b = {},
                    .restitution = 1,
                    .friction = 0,
                    .normal_stiffness = 1e6,
                    .normal_damping = damping,
                    .tangential_stiffness = 0,
                    .tangential_damping = 0};
    const double overlap = 0.05 * radius;
    const double k = 1.5 * pair.normal_stiffness * std::sqrt(overlap), c = damping * std::pow(overlap, 0.25);
    const double limit = contact_time(radius, mass, pair);
    std::cout << "c_n " << damping << ": limit " << limit << " s\n";
    EXPECT_TRUE(stable(0.99 * limit, k, c, mass)) << damping;
    EXPECT_FALSE(stable(1.02 * limit, k, c, mass)) << damping;
  }
}

// Two equal spheres of law `paper` that collide; k = 1, m* = 1, closing speed 1: x'' = -x^(3/2).
struct Collision {
  double duration, rebound;
};
Collision collide(double step, double phase) {
  double x = -phase * step, v = 1, t = -phase * step;
  while (v > 0 || x > 0) {
    v -= step * (x > 0 ? std::pow(x, 1.5) : 0);
    x += step * v;
    t += step;
  }
  return {t - x / v, -v};
}
Dem colliding(ContactLaw law) {
  Dem dem;
  dem.contact = law;
  dem.materials = {
      {.name = "glass", .density = 1.5 / std::numbers::pi, .young = 7e10, .poisson = 0.25}};  // m* = 1
  Pair pair;
  pair.a = pair.b = MaterialId{0};
  pair.normal_stiffness = pair.spring_stiffness = 1;
  dem.pairs = {pair};
  return dem;
}

TEST(TimeStep, CollisionTimeIsThatOfHertz) {
  const Collision fine = collide(1e-4, 0.5);
  const double measured = collision_time(colliding(ContactLaw::paper), MaterialId{0}, 1, 1);
  std::cout << "expected " << fine.duration << " measured " << measured << " tolerance 1e-5\n";
  EXPECT_NEAR(measured, fine.duration, 1e-5 * fine.duration);
  EXPECT_NEAR(collision_time(colliding(ContactLaw::paper), MaterialId{0}, 1, 32) / measured, 0.5, 1e-12);
  EXPECT_NEAR(collision_time(colliding(ContactLaw::hooke), MaterialId{0}, 1, 7), std::numbers::pi, 1e-12);
  // E* = E / (2 (1 - nu^2)), R* = r/2: k of glass.
  const double k = 4.0 / 3.0 * 7e10 / (2 * (1 - 0.0625)) * std::sqrt(0.5);
  EXPECT_NEAR(collision_time(colliding(ContactLaw::hertz_mindlin), MaterialId{0}, 1, 1) / measured,
              std::pow(k, -0.4), 1e-12 * measured);
}

TEST(TimeStep, SharesOfTheCollisionTimeKeepTheRebound) {
  const double whole = collision_time(colliding(ContactLaw::paper), MaterialId{0}, 1, 1);
  const auto worst = [&](double share) {
    double error = 0;
    for (int phase = 0; phase < 50; ++phase)
      error = std::max(error, std::abs(collide(share * whole, phase / 50.0).rebound - 1));
    return error;
  };
  const double at_limit = worst(largest_collision_share), automatic = worst(automatic_collision_share);
  std::cout << "error of the rebound: " << at_limit << " at the limit (1.1e-2 allowed), " << automatic
            << " automatic (5e-4 allowed)\n";
  EXPECT_LT(at_limit, 1.1e-2);
  EXPECT_LT(automatic, 5e-4);
}

TEST(TimeStep, StiffTangentialSpringCounts) {
  Pair pair{.a = {},
            .b = {},
            .restitution = 1,
            .friction = 0.3,
            .normal_stiffness = 1e6,
            .normal_damping = 0,
            .tangential_stiffness = 0,
            .tangential_damping = 0};
  const double normal = contact_time(0.01, 0.005, pair);
  pair.tangential_stiffness = 1e6;
  EXPECT_NEAR(contact_time(0.01, 0.005, pair) / normal, std::sqrt(2.0 / 7.0), 1e-12);
}

TEST(TimeStep, SmallestAndStiffestSphereDecides) {
  Dem dem;
  dem.materials = {{.name = "soft", .density = 1000, .young = 1e6, .poisson = 0.3},
                   {.name = "stiff", .density = 1000, .young = 1e8, .poisson = 0.3}};
  ParticleGroup soft, stiff;
  soft.material = MaterialId{0};
  soft.radius_min = soft.radius_max = 0.001;
  stiff.material = MaterialId{1};
  stiff.radius_min = 0.005;
  stiff.radius_max = 0.05;
  dem.particles = {soft, stiff};
  EXPECT_DOUBLE_EQ(critical_time(dem), rayleigh_time(0.005, dem.materials[1]));
  dem.particles = {soft};
  EXPECT_DOUBLE_EQ(critical_time(dem), rayleigh_time(0.001, dem.materials[0]));
}

TEST(TimeStep, LawOfThePaperUsesItsOwnStiffness) {
  Dem dem;
  dem.contact = ContactLaw::paper;
  dem.materials = {{.name = "a", .density = 1000, .young = 1e30, .poisson = 0.3}};
  dem.pairs = {{.a = {},
                .b = {},
                .restitution = 1,
                .friction = 0,
                .normal_stiffness = 1e6,
                .normal_damping = 0,
                .tangential_stiffness = 0,
                .tangential_damping = 0}};
  ParticleGroup group;
  group.radius_min = group.radius_max = 0.01;
  dem.particles = {group};
  const double mass = 4.0 / 3.0 * std::numbers::pi * 1e-6 * 1000;
  EXPECT_DOUBLE_EQ(critical_time(dem), contact_time(0.01, mass / 2, dem.pairs[0]));
}

// Undamped, the limit of central differences is 2 / omega with the reduced mass m / 2; damping shortens it.
TEST(TimeStep, LawHookeUsesItsSpring) {
  Dem dem;
  dem.contact = ContactLaw::hooke;
  dem.materials = {{.name = "a", .density = 1000, .young = 1e30, .poisson = 0.3}};
  Pair pair;
  pair.spring_stiffness = 1e5;
  dem.pairs = {pair};
  const double mass = 4.0 / 3.0 * std::numbers::pi * 1e-6 * 1000, undamped = 2 * std::sqrt(mass / 2 / 1e5);
  EXPECT_NEAR(critical_time(dem, MaterialId{}, 0.01) / undamped, 1, 1e-12);
  dem.pairs[0].restitution = 0;
  EXPECT_NEAR(critical_time(dem, MaterialId{}, 0.01) / undamped, std::sqrt(2.0) - 1, 1e-12);
  dem.pairs[0] = pair;
  dem.pairs[0].spring_ratio = 8.0 / 7.0;
  EXPECT_NEAR(critical_time(dem, MaterialId{}, 0.01) / undamped, 0.5, 1e-12);
}

}  // namespace
}  // namespace tandem::scene
