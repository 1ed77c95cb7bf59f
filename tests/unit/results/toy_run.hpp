// A small scene and artificial states for the tests of the results.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch::toy {

// An empty folder for the running test, removed at the end.
class Folder {
 public:
  Folder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() / ("tandem_results_" + std::to_string(::getpid()) + "_" +
                                                      test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  operator const std::filesystem::path&() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// A wheel (hinged to the ground, cylinder wall), a rod without walls, a floor plane and an open box on the
// ground.
inline scene::Scene machine() {
  scene::Scene scene;
  scene.name = "toy";
  scene.mbd.emplace();
  scene.mbd->bodies = {
      {.name = "wheel", .mass = 2, .inertia = {1, 1, 1, 0, 0, 0}, .pose = {{0, 0, 1}, {}}, .twist = {}},
      {.name = "rod", .mass = 12, .inertia = {13, 10, 5, 0, 0, 0}, .pose = {{3, 0, 1}, {}}, .twist = {}}};
  scene.mbd->joints = {{.name = "hinge", .type = scene::JointType::revolute, .parent = ground, .child = {0}}};
  scene.dem.emplace();
  scene.dem->domain = {{-1, -1, 0}, {1, 1, 2}};
  scene.dem->walls = {{.name = "rim",
                       .body = {0},
                       .material = {},
                       .pose = {},
                       .shape = scene::CylinderShape{0.5, 0.2, 24, {}}},
                      {.name = "floor",
                       .body = ground,
                       .material = {},
                       .pose = {},
                       .shape = scene::PlaneShape{{0, 0, 0.5}, {0, 0, 1}}},
                      {.name = "bin",
                       .body = ground,
                       .material = {},
                       .pose = {{0, 0, 0.5}, {}},
                       .shape = scene::BoxShape{{1, 1, 1}, {"+z"}}}};
  return scene;
}

inline protocol::BodiesFrame bodies_frame(double time) {
  protocol::BodiesFrame frame;
  frame.time = to_nanoseconds(time);
  frame.bodies = {{0, 0, {{0, 0, 1}, exp({0, 0, time})}, {{}, {0, 0, 1}}},
                  {1, 0, {{3, 0, 1 + time}, {}}, {{0, 0, 1}, {}}}};
  frame.joints = {{0, 0, time, 1, {{1, 2, 3}, {4, 5, 6}}}};
  return frame;
}

// `count` spheres in a row along x that move up at `time` m/s.
inline protocol::ParticlesFrame particles_frame(double time, std::uint32_t count) {
  protocol::ParticlesFrame frame;
  frame.time = to_nanoseconds(time);
  for (std::uint32_t i = 0; i < count; ++i) {
    frame.id.push_back(i);
    frame.position.insert(frame.position.end(), {0.1 * i, 0.25, time});
    frame.velocity.insert(frame.velocity.end(),
                          {3.0f * static_cast<float>(time), 0, 4.0f * static_cast<float>(time)});
    frame.spin.insert(frame.spin.end(), {0, 0, 1});
    frame.radius.push_back(0.05f);
  }
  return frame;
}

inline protocol::LoadSet loads(double force) {
  protocol::LoadSet set;
  set.bodies.resize(2);
  set.bodies[0].body = ground.value;
  set.bodies[0].mean = {{0, 0, -force}, {}};
  set.bodies[1].body = 0;
  set.bodies[1].mean = {{force, 0, 0}, {0, force, 0}};
  return set;
}

}  // namespace tandem::launch::toy
