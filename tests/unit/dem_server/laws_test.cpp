// Contact laws against closed forms, through the engine, so that the tested code is the code that runs.
// Impacts with every variant are in tests/verification/dem.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/paper.hpp"
#include "tests/support/particle_run.hpp"

namespace tandem::test {
namespace {

// Spheres over a plane of the same material, without gravity.
std::string impact_scene(const std::string& law, double young, double poisson, double density,
                         double restitution, double friction, double radius, int count) {
  char text[2000];
  std::snprintf(text, sizeof text,
                R"({"tandem": "1.0", "name": "impact", "gravity": [0, 0, 0], "end_time": 1,
      "dem": {"contact": "%s", "precision": "double",
        "materials": [{"name": "m", "density": %.17g, "young": %.17g, "poisson": %.17g}],
        "pairs": [{"a": "m", "b": "m", "restitution": %.17g, "friction": %.17g,
                   "normal_stiffness": 1e9, "normal_damping": 0, "tangential_stiffness": 1e9, "tangential_damping": 0}],
        "particles": [{"name": "p", "material": "m", "radius": %.17g,
          "fill": {"type": "lattice", "min": [%.17g, %.17g, %.17g], "max": [%.17g, %.17g, %.17g], "spacing": %.17g, "count": %d}}],
        "walls": [{"name": "w", "material": "m", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
        "domain": {"min": [%.17g, %.17g, %.17g], "max": [%.17g, %.17g, %.17g]}}})",
                law.c_str(), density, young, poisson, restitution, friction, radius, -5 * radius, -5 * radius,
                2 * radius, 5 * radius, 5 * radius, 12 * radius, 3 * radius, count, -50 * radius,
                -50 * radius, -10 * radius, 50 * radius, 50 * radius, 90 * radius);
  return text;
}

void report(const char* what, double measured, double expected, double tolerance) {
  std::printf("%-44s expected %14.8g measured %14.8g error %9.2e tolerance %7.1e\n", what, expected, measured,
              std::abs(measured - expected) / std::abs(expected), tolerance);
  EXPECT_NEAR(measured, expected, tolerance * std::abs(expected)) << what;
}

// The paper's normal law without damping is Hertz's with a given stiffness: the deepest overlap follows from
// energy.
TEST(Paper, ElasticImpactReachesTheEnergyDepth) {
  const double R = 0.0025, v = 2, rho = 4000, k = 1e9;
  ParticleRun run(impact_scene("paper", 3.8e11, 0.23, rho, 1, 0.3, R, 1), dem::Backend::cpu, 1,
                  [&](dem::Spheres& s) {
                    s.position = {{0, 0, R}};
                    s.velocity = {{0, 0, -v}};
                  });
  for (int w = 0; w < 200; ++w) run.advance(500, 2e-9);
  const double mass = 4.0 / 3 * std::numbers::pi * rho * R * R * R;
  report("deepest overlap [m]", R * static_cast<double>(run.advance(1, 2e-9).window.max_overlap_ratio),
         std::pow(1.25 * mass * v * v / k, 0.4), 1e-3);
  report("speed after [m/s]", run.state().velocity[0].z, v, 1e-5);
}

// A sphere that slides on a plane under the paper's law starts to roll at 5/7 of its speed.
TEST(Paper, SlidingSphereEndsRollingAtFiveSevenths) {
  std::string json = impact_scene("paper", 1e8, 0.25, 2500, 1, 0.3, 0.01, 1);
  json.replace(json.find("[0, 0, 0]"), 9, "[0, 0, -9.81]");
  const double k = 1e9, mass = 4.0 / 3 * std::numbers::pi * 2500 * 1e-6;
  ParticleRun run(json, dem::Backend::cpu, 1, [&](dem::Spheres& s) {
    s.position = {{0, 0, 0.01 - std::pow(mass * 9.81 / k, 2.0 / 3)}};
    s.velocity = {{0.5, 0, 0}};
  });
  for (int w = 0; w < 100; ++w) run.advance(1000, 1e-6);
  report("rolling speed [m/s]", run.state().velocity[0].x, 0.5 * 5 / 7, 2e-3);
}

// Also for very small springs: squares of lengths have twice the exponent, and the range of single precision
// is small.
TEST(TangentialSpring, KeepsItsLengthWhileThePlaneTurns) {
  dem::Contact<float> c;
  const Vec3f n = c.n = normalized(Vec3f{0.1F, -0.2F, 1});
  for (const float length : {1e-18F, 1e-15F, 1e-12F, 1e-9F, 1e-6F, 1e-3F}) {
    const Vec3f rotate_spring = dem::rotate_spring(Vec3f{length, 0, 0}, c, 1e-7F, 1e-7F);
    EXPECT_NEAR(norm(rotate_spring.as<double>()) / static_cast<double>(length), 1, 3e-7) << length;
    EXPECT_NEAR(dot(rotate_spring.as<double>(), n.as<double>()) / static_cast<double>(length), 0, 1e-7)
        << length;
    EXPECT_NEAR(norm(dem::rotate_spring(Vec3f{length, 0, 0}, c, 1e-7F, 4e-7F).as<double>()) /
                    static_cast<double>(length),
                0.5, 3e-7)
        << length;
  }
  EXPECT_EQ(dem::rotate_spring(Vec3f{1e-25F, 0, 0}, c, 1e-7F, 1e-7F), Vec3f{});
  EXPECT_EQ(dem::rotate_spring(Vec3f{1e-6F, 0, 0}, c, 0.0F, 1e-7F), Vec3f{});  // a new contact
  EXPECT_EQ(dem::rotate_spring(Vec3f{}, c), Vec3f{});
}

TEST(TangentialSpring, KeepsAnyAngleWhileThePlaneTurns) {
  dem::Contact<float> c;
  c.n = normalized(Vec3f{0.1F, -0.2F, 1});
  for (const float angle : {1e-15F, 1e-6F, 1.0F, 1e4F}) {
    const Vec3f rotate_spring =
        dem::rotate_spring(Vec3f{angle, 0, 0}, c, 1.0F, 1.0F, dem::finer_angles<float>);
    EXPECT_NEAR(norm(rotate_spring.as<double>()) / static_cast<double>(angle), 1, 3e-7) << angle;
  }
}

// Each of two spheres in contact evaluates the law itself, and their forces have to be opposite to the bit.
TEST(Coefficients, OfTwoInSeriesAreTheSameFromEitherSide) {
  float a = 1e-6F;
  for (int i = 0; i < 200; ++i, a *= 1.0731F) {
    float b = 1.37e-6F;
    for (int k = 0; k < 200; ++k, b *= 1.0812F) {
      ASSERT_EQ(dem::in_series(a, b), dem::in_series(b, a)) << a << " " << b;
      const double exact = 1 / (1 / static_cast<double>(a) + 1 / static_cast<double>(b));
      ASSERT_NEAR(static_cast<double>(dem::in_series(a, b)) / exact, 1, 2e-7);
    }
  }
}

TEST(TangentialSpring, SlidesAtCoulombsLimitHoweverSmall) {
  for (const float limit : {1e-17F, 1e-12F, 1e-6F, 1.0F, 1e6F}) {
    dem::ContactForce<float> f;
    f.k_t = 1e3F;
    f.c_t = 1;
    Vec3f spring{3 * limit / f.k_t, 0, 0};
    dem::limit_friction(f, Vec3f{0, limit, 0}, limit, spring);
    EXPECT_NEAR(norm(f.tangential.as<double>()) / static_cast<double>(limit), 1, 3e-7);
    EXPECT_NEAR(static_cast<double>(f.k_t) * norm(spring.as<double>()) / static_cast<double>(limit), 1, 3e-7);
    // Within the limit nothing is cut off.
    spring = {limit / 2 / f.k_t, 0, 0};
    dem::limit_friction(f, Vec3f{}, limit, spring);
    EXPECT_EQ(f.tangential, -(f.k_t * spring));
  }
  dem::ContactForce<float> f;
  f.k_t = 1e3F;
  Vec3f spring{1e-6F, 0, 0};
  dem::limit_friction(f, Vec3f{}, 0.0F, spring);
  EXPECT_EQ(f.tangential, Vec3f{});
  EXPECT_EQ(spring, Vec3f{});
}

}  // namespace
}  // namespace tandem::test
