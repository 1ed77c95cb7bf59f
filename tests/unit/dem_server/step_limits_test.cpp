#include "dem_server/laws/step_limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include "common/error.hpp"
#include "dem_server/laws/generic.hpp"
#include "dem_server/laws/stiffer.hpp"

namespace tandem::dem {
namespace {

using scene::ContactLaw, scene::Dem, scene::Material, scene::Pair, scene::ParticleGroup;

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

TEST(StepLimits, RayleighTimeOfGlass) {
  const Material glass{.name = "glass", .density = 2500, .young = 7e10, .poisson = 0.25};
  const double shear = 2.8e10;
  const double expected = std::numbers::pi * 0.01 * std::sqrt(2500 / shear) / (0.1631 * 0.25 + 0.8766);
  const double measured = rayleigh_time(0.01, glass);
  std::cout << "expected " << expected << " measured " << measured << " tolerance 1e-12 relative\n";
  EXPECT_NEAR(measured / expected, 1, 1e-12);
}

TEST(StepLimits, ContactTimeIsTheLimitOfStability) {
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
    const double limit = Paper::contact_time(pair, mass, radius);
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

TEST(StepLimits, CollisionTimeIsThatOfHertz) {
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

TEST(StepLimits, SharesOfTheCollisionTimeKeepTheRebound) {
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

TEST(StepLimits, StiffTangentialSpringCounts) {
  Pair pair{.a = {},
            .b = {},
            .restitution = 1,
            .friction = 0.3,
            .normal_stiffness = 1e6,
            .normal_damping = 0,
            .tangential_stiffness = 0,
            .tangential_damping = 0};
  const double normal = Paper::contact_time(pair, 0.005, 0.01);
  pair.tangential_stiffness = 1e6;
  EXPECT_NEAR(Paper::contact_time(pair, 0.005, 0.01) / normal, std::sqrt(2.0 / 7.0), 1e-12);
}

TEST(StepLimits, SmallestAndStiffestSphereDecides) {
  Dem dem;
  dem.materials = {{.name = "soft", .density = 1000, .young = 1e6, .poisson = 0.3},
                   {.name = "stiff", .density = 1000, .young = 1e8, .poisson = 0.3}};
  ParticleGroup soft, stiff;
  soft.material = MaterialId{0};
  soft.radius_min = soft.radius_max = 0.001;
  stiff.material = MaterialId{1};
  stiff.radius_min = 0.005;
  stiff.radius_max = 0.05;
  for (const std::uint32_t a : {0, 1})
    for (std::uint32_t b = a; b < 2; ++b) {
      Pair pair;
      pair.a = MaterialId{a};
      pair.b = MaterialId{b};
      dem.pairs.push_back(pair);
    }
  dem.particles = {soft, stiff};
  EXPECT_DOUBLE_EQ(critical_time(dem), rayleigh_time(0.005, dem.materials[1]));
  dem.particles = {soft};
  EXPECT_DOUBLE_EQ(critical_time(dem), rayleigh_time(0.001, dem.materials[0]));
}

TEST(StepLimits, LawOfThePaperUsesItsOwnStiffness) {
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
  EXPECT_DOUBLE_EQ(critical_time(dem), Paper::contact_time(dem.pairs[0], mass / 2, 0.01));
}

// Undamped, the limit of central differences is 2 / omega with the reduced mass m / 2; damping shortens it.
TEST(StepLimits, LawHookeUsesItsSpring) {
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

std::string refusal(const Dem& dem) {
  try {
    check_micro_step(dem, "scene.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(StepLimits, AGivenStepAboveTheLimitIsRefused) {
  Dem dem = colliding(ContactLaw::hertz_mindlin);
  ParticleGroup group;
  group.radius_min = group.radius_max = 1;
  dem.particles = {group};
  EXPECT_EQ(refusal(dem), "no error") << "none is given";
  const double critical = critical_time(dem);
  dem.micro_step = 0.4 * critical;
  EXPECT_EQ(refusal(dem), "no error");
  dem.micro_step = 4e-5;
  EXPECT_EQ(refusal(dem),
            "scene.json: dem.micro_step: the micro step of 4e-05 s is above the stable 5.65656e-06 s, 0.4 of "
            "the Rayleigh "
            "time (leave it out for 2.82829e-06 s)");
  dem.contact = ContactLaw::paper;
  dem.micro_step = 4;
  EXPECT_EQ(refusal(dem),
            "scene.json: dem.micro_step: the micro step of 4 s is above the stable 1.38134 s, 0.4 of the "
            "contact time "
            "(leave it out for 0.690672 s)");
  dem.particles[0].fixed = true;
  EXPECT_EQ(refusal(dem), "no error") << "nothing moves";
}

TEST(StepLimits, ASphereOfAFileThatIsTooSmallIsNamed) {
  Dem dem = colliding(ContactLaw::hertz_mindlin);
  dem.micro_step = 0.3 * critical_time(dem, MaterialId{0}, 1);
  check_micro_step(dem, "scene.json", MaterialId{0}, {1, 0.8}, "grains.csv");
  try {
    check_micro_step(dem, "scene.json", MaterialId{0}, {1, 0.7}, "grains.csv");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("of sphere 2 of grains.csv (leave it out to have it chosen)"),
              std::string::npos)
        << error.what();
  }
}

// A collision of the same energy compresses to `ratio` of the overlap: d ~ k^-0.4, and k^-0.5 for `hooke`.
TEST(StepLimits, StifferNamesTheConstantOfTheLaw) {
  const double hertz = std::pow(0.95 * 0.5, -2.5), hooke = std::pow(0.95 * 0.5, -2);
  EXPECT_EQ(stiffer(colliding(ContactLaw::hertz_mindlin), 0.5),
            "young = 4.5e+11 Pa (now 7e+10) for the material 'glass'");
  EXPECT_EQ(stiffer(colliding(ContactLaw::paper), 0.5),
            "normal_stiffness = 6.4 (now 1) for the pair 'glass' and 'glass'");
  EXPECT_EQ(stiffer(colliding(ContactLaw::hooke), 0.5),
            "spring_stiffness = 4.4 (now 1) for the pair 'glass' and 'glass'");
  EXPECT_NEAR(step_of_stiffer(colliding(ContactLaw::jkr), 0.5), 1 / std::sqrt(hertz), 1e-12);
  EXPECT_NEAR(step_of_stiffer(colliding(ContactLaw::hooke), 0.5), 1 / std::sqrt(hooke), 1e-12);
}

}  // namespace
}  // namespace tandem::dem
