// Scenes of bodies that touch, and their runs.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "common/log.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd::contacts {

constexpr double g = 9.81;

inline void expect_near(const std::string& what, double measured, double expected, double tolerance) {
  std::printf("  %-58s expected %14.9g measured %14.9g tolerance %.1e\n", what.c_str(), expected, measured,
              tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

// Bodies on the plane z = 0 of the ground.
struct ContactScene {
  scene::Scene scene;

  explicit ContactScene(Vec3d gravity = {0, 0, -g}) : scene(machines::empty(gravity)) {
    scene.contact.emplace();
    scene.contact->materials.push_back({"stuff", 1e6, 0, 0, 1, 0});
  }
  scene::ContactMaterial& material() { return scene.contact->materials[0]; }
  void add_floor() {
    scene::Shape floor;
    floor.name = "floor";
    floor.use = scene::ShapeUse::contact;
    floor.contact_material = 0;
    floor.geometry = scene::PlaneShape{{0, 0, 0}, {0, 0, 1}};
    scene.contact->ground.push_back(floor);
  }
  BodyId add(const std::string& name, double mass, Vec3d inertia, Vec3d position, scene::Geometry geometry) {
    const BodyId body = machines::add_body(scene, name, mass, inertia, position);
    scene::Shape shape;
    shape.name = name;
    shape.use = scene::ShapeUse::contact;
    shape.body = body;
    shape.contact_material = 0;
    shape.is_of_body = true;
    shape.geometry = std::move(geometry);
    scene.shapes.push_back(shape);
    return body;
  }
  BodyId add_ball(const std::string& name, double mass, double radius, Vec3d position) {
    const double J = 0.4 * mass * radius * radius;
    return add(name, mass, {J, J, J}, position, scene::SphereShape{radius});
  }
  BodyId add_box(const std::string& name, double mass, Vec3d size, Vec3d position) {
    const auto J = [&](double a, double b) { return mass / 12 * (a * a + b * b); };
    return add(name, mass, {J(size.y, size.z), J(size.x, size.z), J(size.x, size.y)}, position,
               scene::BoxShape{size, {}});
  }
  scene::Body& body(BodyId id) { return scene.mbd->bodies[id.value]; }
};

struct ContactRun {
  MbdSolver solver;
  double window;
  std::uint64_t done = 0;
  double start_energy, largest_energy;

  ContactRun(scene::Scene scene, double window_, const std::vector<NamedMesh>& meshes = {})
      : window(window_) {
    log::setup("test", "error");
    scene.coupling.window = window;
    solver.configure(scene, meshes);
    start_energy = largest_energy = solver.observe().energy;
  }
  void advance(int windows) {
    protocol::LoadSet loads;
    for (int i = 0; i < windows; ++i, ++done) {
      loads.window = {done, to_nanoseconds(static_cast<double>(done) * window),
                      to_nanoseconds(static_cast<double>(done + 1) * window)};
      solver.advance(loads);
      largest_energy = std::max(largest_energy, solver.observe().energy);
    }
  }
  Vec3d position(std::size_t body = 0) { return solver.observe().bodies[body].pose.p_WB; }
  Vec3d velocity(std::size_t body = 0) { return solver.observe().bodies[body].twist.v_WB; }
  Vec3d spin(std::size_t body = 0) { return solver.observe().bodies[body].twist.w_WB; }
  nlohmann::json facts() { return nlohmann::json::parse(solver.report().facts); }
};

// Boxes that are turned and fall into each other.
inline ContactScene falling_boxes(int count, bool reversed = false) {
  ContactScene s;
  s.add_floor();
  s.material() = {"stuff", 1e5, 0, 0, 0.2, 0.5};
  for (int k = 0; k < count; ++k) {
    const int i = reversed ? count - 1 - k : k;
    const BodyId box = s.add_box("box" + std::to_string(i), 1, {0.1, 0.1, 0.1},
                                 {0.18 * (i % 3), 0.18 * (i / 3 % 2), 0.1 + 0.18 * (i / 6)});
    s.body(box).pose.q_WB = exp(Vec3d{std::sin(i), std::sin(3 * i), std::sin(7 * i)});
  }
  return s;
}

// Runs the scene for twice so many windows of 2 ms: again, with a rollback over `back` windows in the middle,
// and with a restart there.
inline void expect_same_bits_after_rollback_and_restart(const scene::Scene& scene, int windows, int back,
                                                        const std::string& name) {
  const auto hash = [](ContactRun& run) { return run.facts().at("mbd_state_hash").get<std::string>(); };
  const auto begun = [&](ContactRun& run) -> ContactRun& {
    run.advance(windows);
    return run;
  };
  ContactRun plain(scene, 2e-3), again(scene, 2e-3), rolled(scene, 2e-3), restarted(scene, 2e-3);
  begun(plain).advance(windows);
  begun(again);
  const std::filesystem::path file = std::filesystem::temp_directory_path() / name;
  protocol::Checkpoint at;
  at.path = file.string(), at.time = to_nanoseconds(2e-3 * windows);
  again.solver.checkpoint(at);
  again.advance(windows);
  begun(rolled).solver.save();
  rolled.advance(back);
  rolled.done -= static_cast<std::uint64_t>(back);
  rolled.solver.restore();
  rolled.advance(windows);
  restarted.solver.resume(at);
  restarted.done = static_cast<std::uint64_t>(windows);
  restarted.advance(windows);
  std::filesystem::remove(file);
  EXPECT_EQ(hash(again), hash(plain));
  EXPECT_EQ(hash(rolled), hash(plain));
  EXPECT_EQ(hash(restarted), hash(plain));
}

// Largest error of the heights of bodies of 1 kg on each other, each pressed into the one below by the weight
// of those above it [m]. `first`: centre of the lowest one, `distance` to the next, without weight [m].
inline double error_of_heights(ContactRun& run, int count, double first, double distance, double stiffness) {
  double height = first, worst = 0;
  for (int i = 0; i < count; ++i, height += distance) {
    height -= (count - i) * g / stiffness;
    worst = std::max(worst, std::abs(run.position(static_cast<std::size_t>(i)).z - height));
  }
  return worst;
}

// Contacts never give energy.
inline void expect_energy(const ContactRun& run, double tolerance) {
  expect_near("largest energy above that at the start, over that",
              (run.largest_energy - run.start_energy) / run.start_energy, 0, tolerance);
}

}  // namespace tandem::mbd::contacts
