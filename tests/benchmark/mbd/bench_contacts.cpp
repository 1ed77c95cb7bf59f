// Processor time of contacts between bodies over their number:
//
//   bench_contacts TOPOLOGY BODIES STEPS [stepping]
//
// With `stepping` by time stepping (mbd.contact.impacts), in steps of 2 ms.
//
// TOPOLOGY is pairs (two boxes on each other, many such pairs beside each other on a floor), wall (boxes in
// bond, as high as wide), pile (boxes in bond in both directions, as high as wide) or heap (turned boxes and
// balls that fall 1 cm in a box of planes, as high as wide). They settle for 0.3 s, a heap for 0.6 s, and are
// then measured over STEPS windows of 1 ms. Prints a row: topology, bodies, points in contact, windows,
// us per window, us per window and point, Newton iterations per window, of all islands together.
//
// A well is turned boxes that fall into a well of planes, as high as wide: it is measured from the start over
// STEPS windows of 2 ms, with a row for each 50 of them. The time is the mean of the windows there, else the
// median.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/cpu_time.hpp"
#include "common/log.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

constexpr double side = 0.2, height = 0.1, gap = 0.01;

struct Bricks {
  scene::Scene scene = machines::empty({0, 0, -9.81});
  int count = 0;

  Bricks() {
    scene.contact.emplace();
    scene.contact->materials.push_back({"stone", 1e6, 0, 0, 0.2, 0.5});
    add_plane("floor", {0, 0, 0}, {0, 0, 1});
  }
  void add_plane(const char* name, Vec3d point, Vec3d normal) {
    scene::Shape plane;
    plane.name = name;
    plane.use = scene::ShapeUse::contact;
    plane.contact_material = 0;
    plane.geometry = scene::PlaneShape{point, normal};
    scene.contact->ground.push_back(plane);
  }
  void add(Vec3d at, Vec3d size) {
    const auto J = [&](double a, double b) { return (a * a + b * b) / 12; };
    add(at, {J(size.y, size.z), J(size.x, size.z), J(size.x, size.y)}, scene::BoxShape{size, {}});
  }
  void add(Vec3d at, Vec3d inertia, scene::Geometry geometry) {
    scene::Shape shape;
    shape.name = "brick" + std::to_string(count++);
    shape.body = machines::add_body(scene, shape.name, 1, inertia, at);
    shape.use = scene::ShapeUse::contact;
    shape.is_of_body = true;
    shape.contact_material = 0;
    shape.geometry = std::move(geometry);
    scene.shapes.push_back(shape);
  }
};

scene::Scene made(const std::string& topology, int bodies) {
  Bricks b;
  const double pitch = side + gap;
  const Vec3d size{side, side, height};
  const auto layer = [](int i) { return height * (i + 0.5); };
  if (topology == "pairs") {
    const int wide = static_cast<int>(std::ceil(std::sqrt(bodies / 2)));
    for (int i = 0; i < bodies; ++i)
      b.add({2 * pitch * (i / 2 % wide), 2 * pitch * (i / 2 / wide), layer(i % 2)}, size);
  } else if (topology == "wall") {
    const int wide = static_cast<int>(std::ceil(std::sqrt(bodies)));
    for (int i = 0; i < bodies; ++i)
      b.add({pitch * (i % wide + 0.5 * (i / wide % 2)), 0, layer(i / wide)}, size);
  } else if (topology == "heap") {
    const int wide = static_cast<int>(std::ceil(std::cbrt(bodies)));
    const double room = 0.2, half = 0.5 * room * wide, inertia = 0.4 * 0.08 * 0.08;
    b.add_plane("left", {-half, 0, 0}, {1, 0, 0}), b.add_plane("right", {half, 0, 0}, {-1, 0, 0});
    b.add_plane("front", {0, -half, 0}, {0, 1, 0}), b.add_plane("back", {0, half, 0}, {0, -1, 0});
    for (int i = 0; i < bodies; ++i) {
      const Vec3d at{room * (i % wide + 0.5) - half, room * (i / wide % wide + 0.5) - half,
                     room * (i / (wide * wide) + 0.5) + 0.01};
      if (i % 2 == 0)
        b.add(at, {0.14, 0.1, 0.08});
      else
        b.add(at, {inertia, inertia, inertia}, scene::SphereShape{0.08});
      b.scene.mbd->bodies.back().pose.q_WB = exp(Vec3d{std::sin(i), std::sin(3 * i), std::sin(7 * i)});
    }
  } else if (topology == "well") {
    const int wide = static_cast<int>(std::ceil(std::cbrt(bodies)));
    const double room = 0.178, half = 0.5 * room * wide;
    b.scene.contact->materials[0].stiffness = 1e5;
    b.add_plane("left", {-half, 0, 0}, {1, 0, 0}), b.add_plane("right", {half, 0, 0}, {-1, 0, 0});
    b.add_plane("front", {0, -half, 0}, {0, 1, 0}), b.add_plane("back", {0, half, 0}, {0, -1, 0});
    for (int i = 0; i < bodies; ++i) {
      b.add({room * (i % wide + 0.5) - half, room * (i / wide % wide + 0.5) - half,
             room * (i / (wide * wide)) + 0.095},
            {0.1, 0.1, 0.1});
      b.scene.mbd->bodies.back().pose.q_WB = exp(Vec3d{std::sin(i), std::sin(3 * i), std::sin(7 * i)});
    }
  } else {
    const int wide = static_cast<int>(std::ceil(std::cbrt(bodies)));
    for (int i = 0; i < bodies; ++i) {
      const int k = i / (wide * wide);
      b.add({pitch * (i % wide + 0.5 * (k % 2)), pitch * (i / wide % wide + 0.5 * (k % 2)), layer(k)}, size);
    }
  }
  b.scene.coupling.window = topology == "well" ? 2e-3 : 1e-3;
  return b.scene;
}

}  // namespace
}  // namespace tandem::mbd

int main(int count, char** arguments) {
  using namespace tandem;
  if (count != 4 && count != 5) return 2;
  log::setup("bench_contacts", "error");
  const std::string topology = arguments[1];
  const int bodies = std::atoi(arguments[2]), steps = std::atoi(arguments[3]);
  mbd::MbdSolver solver;
  scene::Scene scene = mbd::made(topology, bodies);
  const bool falls = topology == "well", stepping = count == 5;
  if (stepping) {
    scene.contact->impacts = scene::Impacts::time_stepping;
    scene.coupling.window = 2e-3;
  }
  solver.configure(scene);
  const std::int64_t window = falls || stepping ? 2000000 : 1000000;  // [ns]
  std::uint64_t done = 0;
  const auto advance = [&] {
    const auto begin = static_cast<std::int64_t>(done) * window;
    protocol::LoadSet loads;
    loads.window = {done++, {begin}, {begin + window}};
    solver.advance(loads);
  };
  const auto iterations = [&] {
    return nlohmann::json::parse(solver.report().facts)["mbd_newton_iterations"].get<double>();
  };
  const auto measure = [&](int windows) {
    const double before = iterations();
    std::vector<double> times;
    for (int i = 0; i < windows; ++i) {
      const double begin = cpu_seconds(CpuClock::thread);
      advance();
      times.push_back(cpu_seconds(CpuClock::thread) - begin);
    }
    const double sum = std::accumulate(times.begin(), times.end(), 0.0);
    std::nth_element(times.begin(), times.begin() + windows / 2, times.end());
    const double us = 1e6 * (falls ? sum / windows : times[static_cast<std::size_t>(windows / 2)]);
    const auto points = static_cast<double>(solver.state().contacts.size());
    std::printf("%s,%d,%.0f,%d,%.1f,%.3f,%.2f\n", topology.c_str(), bodies, points, windows, us,
                points > 0 ? us / points : 0, (iterations() - before) / windows);
    std::fflush(stdout);
  };
  if (falls) {
    for (int left = steps; left > 0; left -= 50) measure(std::min(left, 50));
    return 0;
  }
  for (int i = 0; i < (topology == "heap" ? 600 : 300); ++i) advance();
  measure(steps);
}
