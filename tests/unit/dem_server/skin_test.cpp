// Thickness of the lists' skin; it changes no result.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"

namespace tandem::test {
namespace {

using particles::Backend;
constexpr double micro_step = 2e-5;  // [s]

constexpr particles::SkinRange range{0.0025, 0.0025 / 16, 0.005};

// Cost of a list per step of its life, and of its candidates [micro steps].
double cost(double skin, double approach) {
  return particles::rebuild_cost * approach / skin + particles::candidate_cost * skin / range.usual;
}

TEST(Skin, TheBestOneCostsLeast) {
  for (const double approach : {1e-6, 1e-5, 5e-5}) {  // [m]
    const double best = range.best(approach);
    const double expected =
        std::sqrt(particles::rebuild_cost / particles::candidate_cost * range.usual * approach);
    std::printf("  approach %.0e m: expected %.6e m measured %.6e m, tolerance 1e-15\n", approach, expected,
                best);
    EXPECT_NEAR(best, expected, 1e-15);
    EXPECT_LT(cost(best, approach), cost(0.99 * best, approach));
    EXPECT_LT(cost(best, approach), cost(1.01 * best, approach));
  }
}

TEST(Skin, StaysWithinItsRange) {
  EXPECT_EQ(range.best(0), range.smallest);
  EXPECT_EQ(range.best(1e-12), range.smallest);
  EXPECT_EQ(range.best(1), range.largest);
  EXPECT_EQ(range.best(std::numeric_limits<double>::infinity()), range.largest);
}

TEST(Skin, AListIsOutlivedWhenItsCandidatesHaveCostANewOne) {
  // Three quarters of the usual skin too thick: 13 / (0.1 * 0.75) = 173.3 steps.
  const double approach = range.usual * 0.0625 * particles::candidate_cost / particles::rebuild_cost;
  ASSERT_NEAR(range.best(approach), 0.25 * range.usual, 1e-15);
  const auto outlived = [approach](double skin, std::uint32_t age) {
    return range.outlived(skin, age * approach, age);
  };
  const auto steps = static_cast<std::uint32_t>(particles::rebuild_cost / (0.75 * particles::candidate_cost));
  EXPECT_FALSE(outlived(range.usual, steps));
  EXPECT_TRUE(outlived(range.usual, steps + 1));
  EXPECT_FALSE(outlived(range.best(approach), 1'000'000'000));
  EXPECT_FALSE(outlived(range.smallest, 1'000'000'000)) << "too thin is no reason";
  EXPECT_FALSE(range.outlived(range.smallest, 0, 1'000'000'000)) << "nothing thinner can be had";
  EXPECT_TRUE(range.outlived(1.1 * range.smallest, 0, 1'000'000'000));
}

scene::Dem dem_of(const std::string& options) {
  return *scene::parse(falling_spheres("hertz_mindlin", options), "test").dem;
}

TEST(Skin, AGivenOneStaysFixed) {
  const particles::SkinRange skins = particles::skins_of(dem_of(R"("skin": 0.003,)"), {0.008, 0.012});
  for (const double approach : {0.0, 1e-5, 1.0}) {
    EXPECT_EQ(skins.best(approach), 0.003);
    EXPECT_FALSE(skins.outlived(0.003, 1e6 * approach, 1'000'000));
  }
  ParticleRun run(falling_spheres("hertz_mindlin", R"("skin": 0.003,)"));
  for (int w = 0; w < 5; ++w) EXPECT_EQ(run.advance(400, micro_step).skin, 0.003);
}

TEST(Skin, RangeFollowsTheMeanRadiusAndThePeriods) {
  scene::Dem dem = dem_of("");
  const particles::SkinRange free = particles::skins_of(dem, {0.008, 0.012});
  EXPECT_NEAR(free.usual, 0.0025, 1e-15);
  EXPECT_NEAR(free.largest, 0.005, 1e-15);
  // A period of 3 (0.024 + 0.004) m has three cells with a largest skin of 0.004 m, less an allowance for
  // rounding.
  dem.domain.max.x = dem.domain.min.x + 0.084;
  dem.periodic[0] = true;
  EXPECT_NEAR(particles::skins_of(dem, {0.008, 0.012}).largest, 0.004, 1e-9);
  EXPECT_LT(particles::skins_of(dem, {0.008, 0.012}).largest, 0.004);
  // The grid refuses a period too short for the usual skin.
  dem.domain.max.x = dem.domain.min.x + 0.07;
  EXPECT_EQ(particles::skins_of(dem, {0.008, 0.012}).largest, free.usual);
}

TEST(Skin, ApproachIsAtTheLargestSpeedOrWithWhatWallsHaveJumped) {
  particles::StepProgress p;
  p.max_speed2 = 4;
  EXPECT_EQ(particles::approach_now(p, 1e-3, 0), 4e-3) << "two spheres";
  EXPECT_EQ(particles::approach_now(p, 1e-3, 5), 7e-3) << "a sphere and a wall";
  p.age = 10;
  p.travel = 0.03;
  p.wall_travel = 0.05;
  EXPECT_EQ(particles::approached(p, 1e-3, 0), 0.05);
  EXPECT_EQ(particles::approached(p, 1e-3, 5), 0.07);
}

// The spheres fall fast, with thick lists, and settle. With rolling resistance, because otherwise the last
// one would roll back and forth for long.
TEST(Skin, ThickWhileSpheresFallAndThinWhenTheyRest) {
  ParticleRun run(falling_spheres("hertz_mindlin", R"("rolling": "elastic_plastic",)"));
  double thickest = 0, last = 0;
  for (int w = 0; w < 120; ++w) {
    last = run.advance(400, micro_step).skin;
    thickest = std::max(thickest, last);
  }
  std::printf("  thickest %.3g m, at rest %.3g m; usual %.3g m\n", thickest, last, run.skins.usual);
  EXPECT_GT(thickest, 1.2 * run.skins.usual);
  EXPECT_LT(last, 0.7 * run.skins.usual);
}

// Into the middle of a list's life, and beyond the next rebuilds.
TEST(Skin, GoesAlongWithASavedState) {
  const std::string json = falling_spheres("hertz_mindlin");
  ParticleRun run(json), threads(json, Backend::cpu, 2), fresh(json, Backend::cpu, 2);
  for (int w = 0; w < 20; ++w) {
    run.advance(333, micro_step);
    threads.advance(333, micro_step);
  }
  const double before = run.advance(1, micro_step).skin;
  threads.advance(1, micro_step);
  const Arrays arrays = written(run);
  run.engine->save();
  const auto end = [](ParticleRun& of) {
    for (int w = 0; w < 30; ++w) of.advance(333, micro_step);
    return std::pair{dem::state_hash(of.state()), of.advance(1, micro_step).skin};
  };
  const auto expected = end(run);
  EXPECT_NE(expected.second, before);
  run.engine->restore();
  EXPECT_EQ(end(run), expected);
  fresh.engine->read([&](const std::string& name) { return arrays.at(name); });
  EXPECT_EQ(end(fresh), expected);
  EXPECT_EQ(end(threads), expected);
}

// Spheres in cells that share a corner may be nearly two diagonals apart: 2.9 times 2^30 quanta here, whose
// square would exceed 63 bits if positions were counted in quanta half as long.
TEST(Skin, SpheresInOppositeCornersOfTwoCellsAreNoNeighbours) {
  const double radius = 0.0124, skin = 0.0031, cell = 2 * radius + skin;
  for (double d = 1.6 * cell; d < 1.99 * cell; d += 0.005 * cell) {
    ParticleRun run(
        falling_spheres("hertz_mindlin", R"("skin": 0.0031,)", 2), Backend::cpu, 1,
        [&](particles::Spheres& s) {
          const Vec3d corner = Vec3d{-0.3, -0.3, -0.1} + 1e-5 * Vec3d{1, 1, 1} + cell * Vec3d{9, 9, 12};
          s.radius = {radius, radius};
          s.position = {corner, corner + d * Vec3d{1, 1, 1}};
          s.velocity = {{}, {}};
        });
    EXPECT_EQ(run.advance(1, micro_step).window.list_entries, 0u) << d;
  }
}

// Between three cells of the usual skin and three of the largest one every period is admissible, although it
// is rounded to quanta.
TEST(Skin, FitsEveryPeriod) {
  PeriodicScene scene;
  scene.radius = 0.01;
  const double diameter = 2 * scene.radius, usual = 0.25 * scene.radius;
  for (double share = 0.01; share < 1; share += 0.03) {
    scene.size = 3 * (diameter + (1 + share) * usual);
    auto json = nlohmann::json::parse(scene.json());
    json["dem"].erase("skin");
    ParticleRun run(json.dump());
    EXPECT_GT(run.skins.largest, usual) << share;
    EXPECT_NO_THROW(run.advance(1, micro_step)) << share;
  }
}

// A period of 3.9 cells has three cells, which are longer.
TEST(Skin, NeitherAreThoseInCellsThatFillAPeriod) {
  PeriodicScene scene;
  scene.radius = 0.0112;
  const double skin = 0.0031, cell = 2 * scene.radius + skin;
  scene.size = 3.9 * cell;
  scene.dem = {{"skin", skin}};
  for (double d = 1.9 * cell; d < 2.1 * cell; d += 0.005 * cell) {
    ParticleRun run = scene.run([&](particles::Spheres& s) {
      s.position = {1e-5 * Vec3d{1, 1, 1}, (d + 1e-5) * Vec3d{1, 1, 1}};
      s.velocity = {{}, {}};
    });
    EXPECT_EQ(run.advance(1, micro_step).window.list_entries, 0u) << d;
  }
}

}  // namespace
}  // namespace tandem::test
