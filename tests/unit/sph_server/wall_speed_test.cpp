// The speed of walls for the warning that they are too fast for the speed of sound.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/geometry/triangle_mesh.hpp"
#include "common/log.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "sph_server/coupling/wall_speed.hpp"

namespace tandem::test {
namespace wall_speed_test {

using particles::BodyPose;
using sph::largest_wall_speed;

// A drum of radius r and length l about an axis that is inclined in the world turns with w about it: its rim
// has the speed w r, however long it is.
TEST(WallSpeed, OfADrumIsThatOfItsRim) {
  constexpr double r = 0.3, l = 2.4, w = 8;
  const TriangleMesh drum = cylinder_mesh(r, l, 24);
  const Vec3d axis = normalized(Vec3d{1, 2, -2});
  const Mat3d R = exp(0.7 * normalized(Vec3d{0, 1, 1})).matrix();
  BodyPose pose{{5, -7, 3}, R, {}, w * (R * Vec3d{0, 0, 1})};
  EXPECT_NEAR(largest_wall_speed(pose, drum.vertices, {}), w * r, 1e-12);
  // About an axis across it the corners at the ends are fastest.
  pose.w = w * (R * Vec3d{0, 1, 0});
  EXPECT_NEAR(largest_wall_speed(pose, drum.vertices, {}), w * std::hypot(r, l / 2), 1e-12);
  // Along the axis of rotation its velocity is at a right angle to that of the rim.
  pose = {{}, R, 1.5 * (R * Vec3d{0, 0, 1}), w * (R * Vec3d{0, 0, 1})};
  EXPECT_NEAR(largest_wall_speed(pose, drum.vertices, {}), std::hypot(1.5, w * r), 1e-12);
  pose = {{}, R, 3.0 * axis, {}};
  EXPECT_NEAR(largest_wall_speed(pose, drum.vertices, {}), 3, 1e-12);
  EXPECT_NEAR(largest_wall_speed(pose, drum.vertices, 2.0 * axis), 1, 1e-12);
  EXPECT_EQ(largest_wall_speed(pose, {}, {}), 0);
}

// Warnings of a run with a shaft of radius 0.3 m and length 4 m beside a liquid whose walls may have 3 m/s.
std::string warnings_of_a_shaft(double w) {
  log::setup("test", "error");
  protocol::Configuration c;
  c.scene_text = R"({
    "tandem": "1.1", "name": "shaft", "end_time": 1, "gravity": [0, 0, 0], "coupling": {"window": 0.002},
    "mbd": {"bodies": [{"name": "shaft", "mass": 5, "inertia": [1, 1, 1], "position": [1, 0, 0]}]},
    "sph": {
      "spacing": 0.05,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "sound_speed": 30, "pressure": "zero",
                   "fill": [{"type": "box", "min": [-0.1, -0.1, 0], "max": [0.1, 0.1, 0.1]}]}],
      "walls": [{"name": "skin", "body": "shaft", "shape": {"type": "cylinder", "radius": 0.3, "height": 4, "segments": 24}}],
      "domain": {"min": [-3, -3, -3], "max": [3, 3, 3]}
    }
  })";
  c.origin = "shaft.json";
  c.backend = "cpu";
  c.threads = 1;
  const auto solver = sph::make_solver();
  solver->configure(c);
  protocol::MotionSet motion;
  motion.window = {0, {}, to_nanoseconds(2e-3)};
  protocol::BodyMotion& body = motion.bodies.emplace_back();
  body.begin_pose = {{1, 0, 0}, {}};
  body.end_pose = {{1, 0, 0}, exp(Vec3d{0, 0, w * 2e-3})};
  body.begin_twist = body.end_twist = {{}, {0, 0, w}};
  solver->advance(motion);
  return nlohmann::json::parse(solver->report().facts)["warnings"].dump();
}

TEST(WallSpeed, IsWarnedOfBeyondATenthOfTheSpeedOfSoundOnly) {
  EXPECT_EQ(warnings_of_a_shaft(8), "[]") << "2.4 m/s";
  const std::string faster = warnings_of_a_shaft(11);
  EXPECT_NE(faster.find("a wall of the liquid has up to 3.3 m/s"), std::string::npos) << faster;
  EXPECT_NE(faster.find("use an expected_speed of 3.3 m/s"), std::string::npos) << faster;
}

}  // namespace wall_speed_test
}  // namespace tandem::test
