// Each law by itself, without the engine: the central impact of two spheres, which the laws answer with the
// restitution of their pair. Impacts through the engine, oblique ones too, are in tests/verification/dem.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "dem_server/laws/generic.hpp"

namespace tandem::dem {
namespace {

constexpr double radius = 0.01, speed = 0.5;

scene::Material glass() {
  return {.name = "glass", .density = 2500, .young = 1e7, .poisson = 0.25};
}

scene::Pair pair_of(double restitution) {
  scene::Pair pair;
  pair.restitution = restitution;
  pair.spring_stiffness = 1e4;
  pair.normal_stiffness = 1e6;
  pair.normal_damping = pair.tangential_stiffness = pair.tangential_damping = 0;
  return pair;
}

// Rebound speed of two equal spheres that meet at `speed` [m/s], by leapfrog with 2,000 steps in the
// collision time of the law.
template <class Law>
double rebound(double restitution) {
  const scene::Material m = glass();
  const scene::Pair pair = pair_of(restitution);
  const double mass = sphere_mass(radius, m) / 2;
  const Coefficients<double> k = coefficients(Law::constants(pair, m, m), radius / 2, mass, radius);
  Contact<double> c;
  c.n = {0, 0, 1};
  c.dt = Law::collision_time(pair, m, m, radius, speed) / 2000;
  c.r_eff = radius / 2;
  c.m_eff = mass;
  c.normal_speed = -speed;
  Vec3d spring;
  for (int step = 0; step < 20000; ++step) {
    c.overlap -= c.dt * c.normal_speed;
    if (!(c.overlap > 0)) return c.normal_speed;
    c.normal_speed += c.dt / mass * Law{}(c, k, 0, spring).normal;
  }
  return -HUGE_VAL;
}

TEST(Laws, CentralImpactsKeepTheRestitution) {
#define LAW(name, Functor)                                                                           \
  for (const double e : {1.0, 0.8, 0.5, 0.2}) {                                                      \
    const double expected = scene::ContactLaw::name == scene::ContactLaw::paper ? speed : e * speed; \
    const double measured = rebound<Functor>(e);                                                     \
    std::printf("%-20s restitution %.1f expected %.6f measured %.6f m/s tolerance 2e-3\n", #name, e, \
                expected, measured);                                                                 \
    EXPECT_NEAR(measured, expected, 2e-3 * speed) << #name << " " << e;                              \
  }
#include "dem_server/laws/laws.def"
#undef LAW
}

// With the critical time of a law, an oscillation about a small overlap neither grows at 0.9 of it nor stays
// bounded at twice that time.
TEST(Laws, CriticalTimeSeparatesStableStepsFromUnstableOnes) {
  const scene::Material m = glass();
  const scene::Pair pair = pair_of(1);
  const auto amplitude = [&]<class Law>(double share) {
    const double mass = sphere_mass(radius, m) / 2, rest = 0.05 * radius;
    const Coefficients<double> k = coefficients(Law::constants(pair, m, m), radius / 2, mass, radius);
    Contact<double> c;
    c.n = {0, 0, 1};
    c.dt = share * Law::critical_time(pair, m, radius);
    c.r_eff = radius / 2;
    c.m_eff = mass;
    Vec3d spring;
    const auto force = [&](double overlap) {
      c.overlap = overlap;
      return Law{}(c, k, 0, spring).normal;
    };
    const double weight = force(rest);
    double x = 1e-3 * rest, v = 0, largest = 0;
    for (int step = 0; step < 2000 && largest < 0.5 * rest; ++step) {
      v -= c.dt / mass * (force(rest + x) - weight);
      x += c.dt * v;
      largest = std::max(largest, std::abs(x));
    }
    return largest / (1e-3 * rest);
  };
#define LAW(name, Functor)                                                                                 \
  {                                                                                                        \
    const double stable = amplitude.template operator()<Functor>(0.4);                                     \
    std::printf("%-20s largest amplitude %.3f of the start at 0.4 of the critical time\n", #name, stable); \
    EXPECT_LT(stable, 1.3) << #name;                                                                       \
  }
#include "dem_server/laws/laws.def"
#undef LAW
  // The laws with stiffnesses of their own have the exact limit; that of Rayleigh is a wave's, and is
  // shorter.
  EXPECT_LT(amplitude.template operator()<Hooke>(0.98), 20);
  EXPECT_GT(amplitude.template operator()<Hooke>(1.02), 100);
  EXPECT_LT(amplitude.template operator()<Paper>(0.98), 20);
  EXPECT_GT(amplitude.template operator()<Paper>(1.02), 100);
}

// Two spheres that are pressed together without motion: 4/3 E* sqrt(R*) overlap^(3/2) with E* = E / (2 (1 -
// nu^2)), by hand.
TEST(Laws, HertzsForceIsThatOfItsMaterials) {
  const scene::Material m = glass();
  const scene::Pair pair = pair_of(0.8);
  const double mass = sphere_mass(radius, m) / 2;
  Contact<double> c;
  c.n = {0, 0, 1};
  c.dt = 1e-6;
  c.r_eff = radius / 2;
  c.m_eff = mass;
  c.overlap = 1e-5;
  Vec3d spring;
  const auto k = coefficients(HertzFrictionless::constants(pair, m, m), radius / 2, mass, radius);
  const double expected = 0.015900928, measured = HertzFrictionless{}(c, k, 0, spring).normal;
  std::printf("force of Hertz: expected %.9f measured %.9f N tolerance 1e-8\n", expected, measured);
  EXPECT_NEAR(measured, expected, 1e-8);
}

}  // namespace
}  // namespace tandem::dem
