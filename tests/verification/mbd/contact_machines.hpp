// Scenes of bodies that touch, and their runs.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
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
