// What an engine says of a region and of the particles near a line, against sums over its whole state.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::test {
namespace {

using namespace sph;

void expect_sum(const char* what, double expected, double measured, double tolerance) {
  std::printf("%s: expected %.12g, measured %.12g, tolerance %.3g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

// A box of 8 x 8 x 6 spacings whose particles move at random.
struct Stirred {
  LiquidSetup setup;
  std::unique_ptr<LiquidEngine> engine;
  LiquidState state;

  explicit Stirred(bool single) {
    const double a = setup.liquid.spacing = 0.1;
    setup.liquid.sound_speed = 30;
    setup.liquid.gravity = {0, 0, -9.81};
    setup.walls = {box_mesh({0.8, 0.8, 1.2}, {"+z"})};
    setup.domain = {{-1, -1, -1}, {1, 1, 1}};
    engine = make_liquid_engine(setup, single);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    LiquidState start;
    for (int k = 0; k < 6; ++k)
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) {
          start.position.push_back(a * Vec3d{i - 3.5, j - 3.5, k - 5.5});
          start.velocity.push_back({any(random), any(random), any(random)});
          start.compression.push_back(0.01 * any(random));
        }
    engine->set_state(start, {{{}, Mat3d::identity(), {}, {}}});
    state = engine->state();
  }
};

class Sensed : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Single, Sensed, testing::Bool());

TEST_P(Sensed, SumsOfARegionAreThoseOfItsParticles) {
  const Stirred stirred(GetParam());
  const double mass = stirred.setup.liquid.mass(), density = stirred.setup.liquid.density;
  for (const bool round : {false, true}) {
    particles::MeasuredRegion region;
    region.p = {0.05, -0.03, -0.3};
    const double c = std::cos(0.4), s = std::sin(0.4);
    region.R.row[0] = {c, -s, 0};
    region.R.row[1] = {s, c, 0};
    region.R.row[2] = {0, 0, 1};
    region.half = round ? Vec3d{0.25, 0.25, 0.2} : Vec3d{0.3, 0.2, 0.25};
    region.round = round;
    region.flow = {0.6, 0, 0.8};
    region.body = {{0.1, 0.2, 0.3}, Mat3d::identity(), {1, 2, 3}, {0.5, 0, -1}};
    particles::RegionSums expected;
    for (std::size_t i = 0; i < stirred.state.size(); ++i) {
      const Vec3d x = stirred.state.position[i], v = stirred.state.velocity[i], d = x - region.p;
      const double along_x = c * d.x + s * d.y, along_y = c * d.y - s * d.x;
      if (d.z < -region.half.z || d.z >= region.half.z) continue;
      if (round ? std::hypot(along_x, along_y) >= 0.25 : std::fabs(along_x) > 0.3 || std::fabs(along_y) > 0.2)
        continue;
      ++expected.count;
      expected.volume += mass / density / (1 + stirred.state.compression[i]);
      expected.moment += mass * x;
      expected.momentum += mass * v;
      expected.kinetic_energy += 0.5 * mass * norm2(v);
      expected.flow_momentum +=
          mass * dot(region.flow, v - region.body.v - cross(region.body.w, x - region.body.p));
    }
    const particles::RegionSums sums = stirred.engine->sums_in(region);
    ASSERT_GT(expected.count, 50u);
    EXPECT_EQ(sums.count, expected.count);
    const double n = static_cast<double>(sums.count) * mass;
    EXPECT_EQ(sums.mass, n);
    expect_sum("volume [m3]", expected.volume, sums.volume, 1e-12 * expected.volume);
    expect_sum("moment, difference [kg m]", 0, norm(sums.moment - expected.moment), 1e-12 * n);
    expect_sum("momentum, difference [kg m/s]", 0, norm(sums.momentum - expected.momentum), 1e-12 * n);
    expect_sum("kinetic energy [J]", expected.kinetic_energy, sums.kinetic_energy,
               1e-12 * expected.kinetic_energy);
    expect_sum("momentum along the flow [kg m/s]", expected.flow_momentum, sums.flow_momentum, 1e-11 * n);
  }
}

TEST_P(Sensed, ParticlesNearALineAreTheNearOnesInOrder) {
  const Stirred stirred(GetParam());
  const LiquidState& all = stirred.state;
  for (const Vec3d along : {Vec3d{0, 0, 1}, Vec3d{0.6, 0.8, 0}, Vec3d{}}) {
    const Vec3d from{0.02, 0.01, -0.31};
    const LiquidState near = stirred.engine->near_line(from, along, 0.17);
    std::size_t found = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Vec3d d = all.position[i] - from;
      if (!(norm(d - dot(d, along) * along) < 0.17)) continue;
      ASSERT_LT(found, near.size());
      EXPECT_EQ(norm(near.position[found] - all.position[i]), 0);
      EXPECT_EQ(norm(near.velocity[found] - all.velocity[i]), 0);
      EXPECT_EQ(norm(near.slope[found] - all.slope[i]), 0);
      EXPECT_EQ(near.compression[found], all.compression[i]);
      EXPECT_EQ(near.pressure[found], all.pressure[i]);
      ++found;
    }
    EXPECT_EQ(near.size(), found);
    EXPECT_GT(found, 5u);
  }
  EXPECT_EQ(stirred.engine->near_line({5, 5, 5}, {}, 0.17).size(), 0u);
}

}  // namespace
}  // namespace tandem::test
