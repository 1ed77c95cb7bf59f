// Spheres that press on walls of a body without a load.
#include "coordinator/watch/wall_load_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

// A box of 1 m on a body, which is open above, over a floor of the ground at z = -2.
scene::Scene box_over_floor(bool with_floor = true) {
  const std::string floor =
      R"(, {"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -2], "normal": [0, 0, 1]}})";
  return scene::parse(
      R"({"tandem": "1.1", "name": "box", "end_time": 1, "coupling": {"window": 0.01},
  "mbd": {"bodies": [{"name": "box", "mass": 1, "inertia": [1, 1, 1]}]},
  "dem": {"materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
          "particles": [{"name": "s", "material": "glass", "radius": 0.1, "fill": {"type": "lattice", "min": [-0.4, -0.4, 1], "max": [0.4, 0.4, 2], "spacing": 0.25}}],
          "walls": [{"name": "sides", "body": "box", "material": "glass", "shape": {"type": "box", "size": [1, 1, 1], "open": ["+z"]}})" +
          (with_floor ? floor : "") + R"(],
          "domain": {"min": [-3, -3, -3], "max": [3, 3, 3]}}})",
      "test");
}

Exchange pressing_window(std::vector<std::uint32_t> loaded, Vec3d velocity = {}) {
  Exchange exchange;
  exchange.load.window = {0, {}, Nanoseconds{10'000'000}};
  exchange.load.account.micro_steps = 100;
  protocol::BodyMotion& path = exchange.path.bodies.emplace_back();
  path.end_pose.p_WB = {1, 0, 0};
  path.end_twist.v_WB = velocity;
  for (const std::uint32_t body : loaded) {
    protocol::BodyLoad& load = exchange.load.bodies.emplace_back();
    load.body = body;
    load.mean.force = {0, 0, -1};
  }
  return exchange;
}

// Spheres at these places relative to the box, with this velocity.
protocol::ParticlesFrame pressing_frame(const std::vector<Vec3d>& places, Vec3f velocity = {}) {
  protocol::ParticlesFrame frame;
  frame.time = Nanoseconds{10'000'000};
  for (const Vec3d& p : places) {
    frame.id.push_back(static_cast<std::uint32_t>(frame.id.size()));
    frame.position.insert(frame.position.end(), {1 + p.x, p.y, p.z});
    frame.velocity.insert(frame.velocity.end(), {velocity.x, velocity.y, velocity.z});
    frame.radius.push_back(0.1f);
  }
  return frame;
}

std::map<std::uint32_t, UnloadedWalls> found(const protocol::ParticlesFrame& frame,
                                             const Exchange& exchange) {
  WallLoadWatch watch(box_over_floor());
  watch.observe(frame, exchange);
  return watch.unloaded();
}

TEST(WallLoadWatch, SpheresThatPressNeedALoadOnTheirBody) {
  const auto inside = pressing_frame({{0, 0, -0.41}, {0.3, 0.2, -0.405}, {0, 0, 0}});
  EXPECT_TRUE(found(inside, pressing_window({0})).empty());
  const auto on_ground = found(inside, pressing_window({ground.value}));
  ASSERT_EQ(on_ground.size(), 1u);
  EXPECT_EQ(on_ground.at(0).spheres, 2u);
  EXPECT_EQ(on_ground.at(0).time, 0.01);
  EXPECT_EQ(on_ground.at(0).example, "sphere 0 overlaps wall 'sides' by 0.01 m");
  const auto of_floor = found(pressing_frame({{0, 0, -1.95}}), pressing_window({0}));
  ASSERT_EQ(of_floor.size(), 1u);
  EXPECT_EQ(of_floor.at(ground.value).example, "sphere 0 overlaps wall 'floor' by 0.05 m");
}

TEST(WallLoadWatch, OnlyContactsThatAreSureCount) {
  const Exchange none = pressing_window({});
  EXPECT_TRUE(found(pressing_frame({{0, 0, -0.41}}, {0, 0, 1}), none).empty()) << "it leaves the wall";
  EXPECT_FALSE(found(pressing_frame({{0, 0, -0.41}}, {0, 0, 1}), pressing_window({}, {0, 0, 2})).empty())
      << "the wall is faster";
  EXPECT_TRUE(found(pressing_frame({{0, 0, -0.39995}}), none).empty()) << "the overlap is rounding";
  EXPECT_TRUE(found(pressing_frame({{0, 0, 0.45}}), none).empty()) << "that face is open";
  EXPECT_TRUE(found(pressing_frame({{0.52, 0.52, 0}}), none).empty()) << "beyond the edge of a face";
  EXPECT_TRUE(found(pressing_frame({{0, 0, -2.2}}), none).empty()) << "behind the plane";
  EXPECT_TRUE(found(pressing_frame({{0.42, 0, 0}, {-0.42, 0, 0}}), none).empty()) << "forces may cancel";
}

// The forces of the last micro step are those of its beginning.
TEST(WallLoadWatch, ContactsThatBeginInTheLastMicroStepsHaveNoLoadYet) {
  const auto falling = [](float speed) { return pressing_frame({{0, 0, -0.401}}, {0, 0, -speed}); };
  EXPECT_TRUE(found(falling(10), pressing_window({})).empty()) << "1 mm, where each step has 1 mm";
  EXPECT_FALSE(found(falling(4), pressing_window({})).empty()) << "there for two steps";
}

TEST(WallLoadWatch, AGroundWithoutWallsHasNoLoad) {
  const WallLoadWatch without(box_over_floor(false));
  EXPECT_NO_THROW(without.record(pressing_window({0})));
  try {
    without.record(pressing_window({ground.value}));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol);
    EXPECT_THAT(error.what(),
                testing::HasSubstr("the ground has a load, and the scene no wall of the ground"));
  }
  EXPECT_NO_THROW(WallLoadWatch(box_over_floor()).record(pressing_window({ground.value})));
}

}  // namespace
}  // namespace tandem::launch
