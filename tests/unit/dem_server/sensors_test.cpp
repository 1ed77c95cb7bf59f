// Sensors of the particles against what is known of spheres in free flight.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/math/rotation.hpp"
#include "tests/support/solver_run.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;

// Places of the values of a region, whose channels are the first ones.
namespace column {
enum : std::size_t {
#define SENSOR_CHANNEL(identifier, ...) identifier,
#include "common/scene/sensor_channels.def"
#undef SENSOR_CHANNEL
};
}  // namespace column

constexpr double ball_volume = 4.0 / 3 * std::numbers::pi * 1e-6, ball_mass = 2500 * ball_volume;

json list(Vec3d v) {
  return {v.x, v.y, v.z};
}
json list(Quat q) {
  return {q.w, q.x, q.y, q.z};
}

constexpr Vec3d tool_at{0.4, 0.05, 1.5};  // out of the way

// 320 spheres of 1 cm in free flight with the velocity of the groups, without contact; the tool moves as
// well.
json flying(Vec3d velocity, const json& sensors, const json& dem = json::object(), Vec3d tool_velocity = {}) {
  json scene = tool_scene(dem);
  scene["gravity"] = {0, 0, 0};
  scene["dem"]["walls"].erase(1);
  scene["mbd"]["bodies"][0]["position"] = list(tool_at);
  scene["mbd"]["bodies"][0]["velocity"] = list(tool_velocity);
  scene["dem"]["particles"][0]["velocity"] = list(velocity);
  scene["dem"]["domain"] = {{"min", {-2, -2, -2}}, {"max", {2, 2, 2}}};
  scene["dem"]["sensors"] = sensors;
  return scene;
}

struct Flight : SolverRun {
  Vec3d tool_velocity, turn;  // [m/s] [rad/s]

  explicit Flight(const json& scene, unsigned threads = 1)
      : SolverRun(scene, "flight.json", threads, "cpu") {}
  void advance(int windows_more) {
    for (int i = 0; i < windows_more; ++i) {
      const auto pose = [&](Nanoseconds t) {
        return Pose{tool_at + to_seconds(t) * tool_velocity, exp(to_seconds(t) * turn)};
      };
      protocol::BodyMotion tool;
      tool.begin_pose = pose(now), tool.end_pose = pose(now + window);
      tool.begin_twist = tool.end_twist = {tool_velocity, turn};
      advance_window({tool});
    }
  }
};

TEST(Sensors, SumAllSpheresInTheRegion) {
  const json sensors = {
      {{"name", "all"}, {"shape", {{"type", "box"}, {"size", {4, 4, 4}}}}},
      // Half of the lattice along x, whose centres begin at 0.01 m.
      {{"name", "half"}, {"position", {-0.5, 0, 0}}, {"shape", {{"type", "box"}, {"size", {1.5, 1, 1}}}}},
      {{"name", "none"},
       {"position", {1, 1, 1}},
       {"shape", {{"type", "cylinder"}, {"radius", 0.1}, {"height", 0.1}}}}};
  const Vec3d v{0.3, -0.2, 0.1};
  Flight run(flying(v, sensors));
  run.advance(1);
  const double n = 320;
  ASSERT_EQ(run.sensed.size(), std::size_t{3 * column::flow});
  EXPECT_EQ(run.sensed[column::count], n);
  EXPECT_NEAR(run.sensed[column::mass], n * ball_mass, 1e-7 * n * ball_mass);
  EXPECT_NEAR(run.sensed[column::volume], n * ball_volume, 1e-7 * n * ball_volume);
  EXPECT_NEAR(run.sensed[column::solid_fraction], n * ball_volume / 64, 1e-11);
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(run.sensed[column::momentum_x + static_cast<std::size_t>(a)], n * ball_mass * v[a], 1e-7);
  EXPECT_NEAR(run.sensed[column::kinetic_energy], 0.5 * n * ball_mass * norm2(v), 1e-7);
  // The middle of the lattice, after one window of flight.
  const Vec3d middle = Vec3d{0.2475, 0.0475, 0.0475} + 1e-3 * v;
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(run.sensed[column::moment_x + static_cast<std::size_t>(a)], n * ball_mass * middle[a], 1e-6);
  EXPECT_EQ(run.sensed[column::flow + column::count], 160);
  for (std::size_t c = 0; c < column::flow; ++c) EXPECT_EQ(run.sensed[2 * column::flow + c], 0);
}

// Whatever the orientation of the region, and of the flight through it.
TEST(Sensors, CountTheMassThatPasses) {
  std::printf("  angle [rad]  expected [kg]  measured [kg]  tolerance [kg]\n");
  for (const double angle : {0.0, -1.2})
    for (const char* axis : {"x", "y", "z"}) {
      // The frame of the sensor, and the direction of flight as its axis.
      const Quat q = exp(angle * normalized(Vec3d{1, 2, -1}));
      Vec3d along;
      along[axis[0] - 'x'] = 1;
      const Vec3d v = 3 * q.rotate(along), middle = Vec3d{0.25, 0.05, 0.05} + 0.4 * q.rotate(along);
      Vec3d size{1.6, 1.6, 1.6};
      size[axis[0] - 'x'] = 0.1;
      const json sensor = {{"name", "gate"},
                           {"position", list(middle)},
                           {"orientation", list(q)},
                           {"shape", {{"type", "box"}, {"size", list(size)}}},
                           {"flow", axis}};
      Flight run(flying(v, json::array({sensor})));
      run.advance(300);  // 0.9 m
      const double expected = 320 * ball_mass;
      std::printf("  %-11.3g  %-13.6g  %-13.6g  %.3g\n", angle, expected, run.sensed[column::passed],
                  0.01 * expected);
      EXPECT_NEAR(run.sensed[column::passed], expected, 0.01 * expected);
      EXPECT_EQ(run.sensed[column::count], 0);
      EXPECT_EQ(run.sensed[column::flow], 0);
    }
}

TEST(Sensors, MoveWithTheirBody) {
  const json sensor = {{"name", "payload"},
                       {"body", "tool"},
                       {"position", {-0.15, 0, -1.45}},
                       {"shape", {{"type", "box"}, {"size", {1.2, 0.5, 0.2}}}},
                       {"flow", "x"}};
  const Vec3d v{1.5, 0, 0.5};
  Flight with(flying(v, json::array({sensor}), json::object(), v));
  with.tool_velocity = v;
  with.advance(200);
  EXPECT_EQ(with.sensed[column::count], 320);
  EXPECT_NEAR(with.sensed[column::flow], 0, 1e-9);
  EXPECT_NEAR(with.sensed[column::passed], 0, 1e-9);

  Flight without(flying({0, 0, 0}, json::array({sensor}), json::object(), {-2, 0, 0}));
  without.tool_velocity = {-2, 0, 0};
  without.advance(50);
  // Spheres at rest move forwards through a region that moves backwards.
  EXPECT_NEAR(without.sensed[column::flow], without.sensed[column::mass] * 2 / 1.2, 1e-9);
}

TEST(Sensors, HaveTheSameBitsWithThreadsAndAfterEachWayBack) {
  const json sensor = {{"name", "gate"},
                       {"body", "tool"},
                       {"position", {-0.15, 0, -1.2}},
                       {"orientation", list(exp({0.2, 0.1, 0.7}))},
                       {"shape", {{"type", "cylinder"}, {"radius", 0.3}, {"height", 0.2}}},
                       {"flow", "z"}};
  for (const char* precision : {"mixed", "double"}) {
    const json scene =
        flying({0.5, 0.1, 4}, json::array({sensor}), {{"precision", precision}}, {0.1, 0, 0.2});
    const auto prepare = [](Flight& run) {
      run.tool_velocity = {0.1, 0, 0.2};
      run.turn = {0, 2, 1};
    };
    Flight straight(scene), threaded(scene, 2), back(scene), resumed(scene);
    for (Flight* run : {&straight, &threaded, &back, &resumed}) prepare(*run);
    straight.advance(120);
    threaded.advance(120);
    EXPECT_GT(std::abs(straight.sensed[column::passed]), 0.01);
    EXPECT_EQ(threaded.sensed, straight.sensed);
    back.advance(60);
    back.solver->save();
    const Nanoseconds then = back.now;
    back.advance(20);
    back.solver->restore();
    back.now = then;
    const std::string file =
        std::filesystem::temp_directory_path() / ("sensed" + std::to_string(getpid()) + ".h5");
    back.solver->checkpoint({60, back.now, file});
    back.advance(60);
    EXPECT_EQ(back.sensed, straight.sensed);
    resumed.solver->resume({60, then, file});
    resumed.now = then;
    resumed.advance(60);
    EXPECT_EQ(resumed.sensed, straight.sensed);
    std::filesystem::remove(file);
  }
}

TEST(Sensors, SayWhereSpheresPassThemUnseen) {
  const auto warnings = [](double length) {
    const json sensor = {{"name", "gate"},
                         {"position", {0.6, 0.05, 0.05}},
                         {"shape", {{"type", "box"}, {"size", {length, 1, 1}}}},
                         {"flow", "x"}};
    Flight run(flying({30, 0, 0}, json::array({sensor})));
    run.advance(30);
    auto sentences = run.report()["warnings"].get<std::vector<std::string>>();
    std::erase_if(sentences, [](const std::string& sentence) { return !sentence.starts_with("sensor"); });
    return sentences;
  };
  EXPECT_THAT(warnings(0.04), testing::IsEmpty());
  EXPECT_THAT(warnings(0.02),
              testing::ElementsAre(testing::HasSubstr(
                  "sensor 'gate' is 0.02 m long along its axis, and spheres moved 0.03 m in one window")));
}

TEST(Sensors, AreMeasuredAtTheStart) {
  const json sensors = {{{"name", "all"}, {"shape", {{"type", "box"}, {"size", {4, 4, 4}}}}}};
  log::setup("test", "error");
  protocol::Configuration c;
  c.scene_text = flying({1, 0, 0}, sensors).dump();
  c.origin = "start.json";
  c.backend = "cpu";
  const auto configured = dem::make_solver()->configure(c);
  ASSERT_EQ(configured.sensors.size(), std::size_t{column::flow});
  EXPECT_EQ(configured.sensors[column::count], 320);
}

// Spheres fall on a floor and a step of the ground, and on the blade of a tool: each wall has its part of the
// load, two sensors of one wall the same, and those of all walls of a body its contact force.
TEST(Sensors, OfWallsMeasureTheirPartOfTheLoad) {
  json scene = tool_scene();
  auto& fill = scene["dem"]["particles"][0]["fill"];
  fill["min"] = {0, 0, 0.03}, fill["max"] = {0.5, 0.1, 0.13};
  scene["mbd"]["bodies"][0]["position"] = {0.25, 0.05, 0.005};
  scene["dem"]["walls"].push_back({{"name", "step"},
                                   {"material", "m"},
                                   {"position", {0.1, 0.05, 0}},
                                   {"shape", {{"type", "box"}, {"size", {0.1, 0.2, 0.01}}}}});
  scene["dem"]["domain"] = {{"min", {-1, -1, -0.02}}, {"max", {1.5, 1.1, 0.3}}};
  for (const char* wall : {"floor", "step", "blade", "floor"})
    scene["dem"]["sensors"].push_back(
        {{"name", std::string("on_") + wall + std::to_string(scene["dem"]["sensors"].size())},
         {"wall", wall}});
  scene["dem"]["sensors"].push_back({{"name", "all"}, {"shape", {{"type", "box"}, {"size", {4, 4, 4}}}}});
  log::setup("test", "error");
  protocol::Configuration c;
  c.scene_text = scene.dump();
  c.origin = "walls.json";
  c.backend = "cpu";
  const auto solver = dem::make_solver();
  constexpr std::size_t channels = 6;
  const std::vector<double> at_start = solver->configure(c).sensors;
  ASSERT_EQ(at_start.size(), 4 * channels + 11);
  EXPECT_EQ(at_start[2], 0) << "nothing has happened yet";
  EXPECT_EQ(at_start[4 * channels], 320) << "the sensor of a region comes after those of the walls";
  protocol::BodyMotion tool{};
  tool.begin_pose = tool.end_pose = {{0.25, 0.05, 0.005}, {}};
  double largest = 0, friction = 0;
  for (std::uint64_t w = 0; w < 150; ++w) {
    protocol::MotionSet motion;
    motion.window = {w, Nanoseconds{static_cast<std::int64_t>(w) * 1'000'000},
                     Nanoseconds{static_cast<std::int64_t>(w + 1) * 1'000'000}};
    motion.bodies = {tool};
    const protocol::LoadSet& loads = solver->advance(motion);
    ASSERT_EQ(loads.bodies.size(), 2u);
    const auto of = [&](std::size_t sensor, int axis) {
      return loads.sensors[sensor * channels + static_cast<std::size_t>(axis)];
    };
    for (int a = 0; a < 3; ++a) {
      const double on_ground = loads.bodies[0].body == ground.value ? loads.bodies[0].mean.force[a]
                                                                    : loads.bodies[1].mean.force[a],
                   on_tool = loads.bodies[0].body == ground.value ? loads.bodies[1].mean.force[a]
                                                                  : loads.bodies[0].mean.force[a];
      EXPECT_NEAR(of(0, a) + of(1, a), on_ground, 1e-8);
      EXPECT_NEAR(of(2, a), on_tool, 1e-8);
      EXPECT_EQ(of(3, a), of(0, a));
    }
    largest = std::max({largest, std::min(-of(0, 2), -of(1, 2))});
    friction += loads.sensors[5] + loads.sensors[channels + 5];
  }
  EXPECT_GT(largest, 0.1) << "spheres lie on the floor and on the step";
  EXPECT_GT(friction, 0);
}

}  // namespace
}  // namespace tandem::test
