// Filling of a region: volumes below a level, number of particles, refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using namespace sph;

// A box [0, 1] x [0, 0.5] x [0, 1] without lid.
struct OpenBox {
  LiquidSetup setup;
  TriangleMesh region = transformed(box_mesh({1, 0.5, 1}), Pose{{0.5, 0.25, 0.5}, {}});
  OpenBox() {
    setup.liquid.spacing = 0.1;
    setup.liquid.sound_speed = 30;
    setup.liquid.gravity = {0, 0, -9.81};
    setup.walls = {transformed(box_mesh({1, 0.5, 1}, {"+z"}), Pose{{0.5, 0.25, 0.5}, {}})};
    setup.domain = {{-0.1, -0.1, -0.1}, {1.1, 0.6, 1.5}};
  }
  LiquidState fill(const FillAmount& amount) const {
    return fill_region(setup, {{{}, Mat3d::identity(), {}, {}}}, {region, amount});
  }
};

TEST(VolumeBelow, ALevelIsExact) {
  const TriangleMesh box = transformed(box_mesh({1, 2, 3}), Pose{{4, 5, 6}, {}});
  EXPECT_NEAR(volume_below(box, {0, 0, 1}, 5.5), 2, 1e-12);
  EXPECT_NEAR(volume_below(box, {1, 0, 0}, 4), 3, 1e-12);
  EXPECT_EQ(volume_below(box, {0, 0, 1}, 4), 0);
  EXPECT_NEAR(volume_below(box, {0, 0, 1}, 9), 6, 1e-12);
  // Half of the box, whatever plane through its centre.
  const Vec3d up = normalized(Vec3d{1, -2, 0.5});
  EXPECT_NEAR(volume_below(box, up, dot(up, {4, 5, 6})), 3, 1e-12);
}

TEST(Fill, OfABoxIsALatticeUnderHydrostaticPressure) {
  const OpenBox box;
  const LiquidState s = box.fill({0.4, {}});
  ASSERT_EQ(s.size(), 10u * 5 * 4);
  EXPECT_EQ(box.fill({{}, 0.2}).size(), s.size()) << "the same level, given by its volume";
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vec3d x = s.position[i];
    const double depth = depth_at_rest(box.setup.liquid, 0.4) - x.z;
    EXPECT_NEAR(s.compression[i], at_rest(box.setup.liquid, depth).compression, 1e-12);
    EXPECT_NEAR(std::remainder(x.x - 0.05, 0.1), 0, 1e-12);
  }
}

TEST(Fill, FollowsGravity) {
  OpenBox box;
  box.setup.liquid.gravity = {9.81, 0, 0};
  for (const Vec3d& x : box.fill({0.3, {}}).position) EXPECT_GT(x.x, 0.7);
}

TEST(Fill, ThatIsImpossibleIsRefused) {
  OpenBox box;
  EXPECT_EQ(
      error_of([&] {
        box.fill({2.0, {}});
      }),
      "scene: fill: a height of 2 m in a region that is 1 m high (give a height above 0 and of at most that "
      "of the region)");
  EXPECT_EQ(
      error_of([&] {
        box.fill({{}, 0.7});
      }),
      "scene: fill: a volume of 0.7 m3 in a region of 0.5 m3 (give a volume above 0 and of at most that of "
      "the region)");
  EXPECT_EQ(error_of([&] { box.fill({}); }),
            "scene: fill: neither or both of height and volume (give one of them)");
  EXPECT_EQ(
      error_of([&] {
        box.fill({{}, 1e-4});
      }),
      "scene: fill: a volume of 0.0001 m3 below the level (fill more than the volume of a particle, 0.001 "
      "m3)");
  box.setup.liquid.gravity = {};
  EXPECT_EQ(error_of([&] {
              box.fill({0.3, {}});
            }),
            "scene: fill: a level without gravity (give gravity, or place the particles otherwise)");
  box.setup.liquid.gravity = {0, 0, -9.81};
  // A mesh may be open above the level.
  const TriangleMesh closed = box.region;
  box.region.triangles.pop_back();
  EXPECT_EQ(box.fill({0.3, {}}).size(), 10u * 5 * 3);
  box.region = closed;
  box.region.triangles.erase(box.region.triangles.begin());
  EXPECT_THAT(error_of([&] { box.fill({0.3, {}}); }), ::testing::HasSubstr("a region that is not closed"));
}

TEST(Hydrostatic, PressureIsThatOfTheMassAbove) {
  Liquid l;
  l.sound_speed = 20;
  l.gravity = {0, -9.81, 0};
  for (const double height : {0.01, 0.3, 2.0}) {
    const double depth = depth_at_rest(l, height);
    EXPECT_LT(depth, height);
    EXPECT_NEAR(at_rest(l, depth).pressure, l.density * 9.81 * height, 1e-9 * l.density * 9.81 * height);
  }
}

}  // namespace
}  // namespace tandem::test
