// What part of a liquid is beyond the limits of speed and density.
#include <gtest/gtest.h>

#include <cmath>

#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::test {
namespace limits_test {

using namespace sph;

TEST(LiquidLimits, CountTheMassThatExceedsThemRelativeToTheVessel) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.01;
  l.sound_speed = 10;
  setup.domain = {{-1, -1, -1}, {9, 9, 1}};
  LiquidState start;
  for (int k = 0; k < 200; ++k) {
    start.position.push_back({0.1 * (k % 20), 0.1 * (k / 20), 0});
    // Two at 0.3 and 0.4 of the speed of sound, three that are off by 0.05, all others just inside.
    start.velocity.push_back({k == 0 ? 3 : k == 1 ? 4 : 1.99, 0, 0});
    start.compression.push_back(k < 197 ? 0.0299 : 0.05);
  }
  for (const bool single : {true, false}) {
    const auto engine = make_liquid_engine(setup, single);
    engine->set_state(start);
    const StepFigures f = engine->figures();
    EXPECT_DOUBLE_EQ(f.fast_share, 0.01);
    EXPECT_NEAR(f.fast_mach, std::sqrt((0.09 + 0.16) / 2), 1e-6);
    EXPECT_DOUBLE_EQ(f.dense_share, 0.015);
    EXPECT_NEAR(f.dense_compression, 0.05, 1e-6);
  }
}

}  // namespace limits_test
}  // namespace tandem::test
