// A liquid at rest in a corner of 30 degrees. A lattice does not fit there: the particles are packed first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"

namespace tandem::test {
namespace {

using namespace sph;

constexpr double g = 9.81, depth = 1, half_angle = std::numbers::pi / 12;

// Two planes that meet at 30 degrees in the line x = z = 0, and two ends; filled up to z = depth.
struct Trough {
  static constexpr int high = 10, deep = 6;  // [spacings]
  LiquidSetup setup;
  LiquidState start;
  TriangleMesh lid;
  Trough() {
    Liquid& l = setup.liquid;
    l.spacing = depth / high;
    l.gravity = {0, 0, -g};
    l.sound_speed = suggested_sound_speed(0, g, depth);
    l.artificial = 0.1;
    const double length = deep * l.spacing, top = 1.6 * depth, side = top * std::tan(half_angle);
    TriangleMesh walls;
    walls.vertices = {{0, 0, 0},      {-side, 0, top},      {side, 0, top},
                      {0, length, 0}, {-side, length, top}, {side, length, top}};
    walls.triangles = {{0, 3, 4}, {0, 4, 1}, {0, 2, 5}, {0, 5, 3}, {0, 1, 2}, {3, 5, 4}};
    setup.walls = {walls};
    setup.slip = true;
    setup.domain = {{-side, -l.spacing, -l.spacing}, {side, length + l.spacing, top}};
    lid.vertices = {{-side, -1, depth}, {side, -1, depth}, {side, 2, depth}, {-side, 2, depth}};
    lid.triangles = {{0, 1, 2}, {0, 2, 3}};
    place(depth * depth * std::tan(half_angle) * length);
  }

  // As many particles as their mass asks for, on the places of a slightly denser lattice that are furthest
  // from the walls; then packed below the lid.
  void place(double volume) {
    const Liquid& l = setup.liquid;
    struct Site {
      double gap;
      Vec3d x;
    };
    std::vector<Site> sites;
    const double a = 0.93 * l.spacing;
    for (double z = a / 2; z < depth - 0.1 * a; z += a)
      for (int j = 0; j < deep; ++j)
        for (int i = -high; i < high; ++i) {
          const Vec3d x{(i + 0.5) * a, (j + 0.5) * l.spacing, z};
          const double gap = x.z * std::sin(half_angle) - std::fabs(x.x) * std::cos(half_angle);
          if (gap > 0) sites.push_back({gap, x});
        }
    std::ranges::stable_sort(sites, [](const Site& p, const Site& q) { return p.gap > q.gap; });
    const double mean_compression = g * depth / 3 / (l.sound_speed * l.sound_speed);
    const auto wanted =
        static_cast<std::size_t>(std::lround(volume * l.density / l.mass() * (1 + mean_compression)));
    ASSERT_GE(sites.size(), wanted);
    for (std::size_t k = 0; k < wanted; ++k) {
      start.position.push_back(sites[k].x);
      start.velocity.push_back({});
      start.compression.push_back(still(sites[k].x.z).compression);
    }
    LiquidSetup packing = setup;
    packing.walls.push_back(lid);
    const auto engine = make_liquid_engine(packing, true);
    engine->set_state(start);
    engine->pack(l.density * g * depth, step(), 0.95, 1200);
    EXPECT_EQ(engine->figures().passed_walls, 0u);
    start = engine->state();
    for (std::size_t i = 0; i < start.size(); ++i) {
      start.velocity[i] = {};
      start.compression[i] = still(start.position[i].z).compression;
    }
  }
  struct Still {
    double pressure, compression;
  };
  Still still(double z) const {
    const double c2 = setup.liquid.sound_speed * setup.liquid.sound_speed,
                 of_c2 = std::max(0.0, std::expm1(g * (depth - z) / c2));
    return {setup.liquid.density * c2 * of_c2, std::pow(1 + 7 * of_c2, 1.0 / 7) - 1};
  }
  double step() const { return step_limits(setup.liquid, 0.1 * setup.liquid.sound_speed, 0).smallest; }
};

TEST(Trough, HoldsALiquidAtRest) {
  const Trough trough;
  const auto engine = make_liquid_engine(trough.setup, true);
  engine->set_state(trough.start);
  const Liquid& l = trough.setup.liquid;
  const double weight = static_cast<double>(trough.start.size()) * l.mass() * g,
               potential = weight * 2 * depth / 3;
  const double dt = trough.step(), end = 14;
  const int steps = static_cast<int>(end / dt);
  double load = 0, late = 0;
  int counted = 0;
  std::printf("trough of 30 degrees, %d spacings high, %zu particles, %.0f s\n", Trough::high,
              trough.start.size(), end);
  for (int k = 0; k < steps; ++k) {
    engine->step(dt);
    if (k % (steps / 5) == 0)
      std::printf("  %5.2f s: kinetic / potential energy %.2e\n", k * dt,
                  engine->energies().kinetic / potential);
    if (k < steps * 5 / 7) continue;
    load -= engine->loads()[0].force.z;
    late = std::max(late, engine->energies().kinetic / potential);
    ++counted;
  }
  expect_figure("load / weight, mean of the last 4 s", 1, load / counted / weight, 1e-4);
  expect_figure("largest kinetic / potential energy in them", 0, late, 1e-6);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  double squares = 0;
  int inside = 0;
  const LiquidState s = engine->state();
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.position[i].z > depth - 2 * l.spacing) continue;
    const double off = (s.pressure[i] - trough.still(s.position[i].z).pressure) / (l.density * g * depth);
    squares += off * off;
    ++inside;
  }
  expect_figure("pressure error / bottom pressure, mean square", 0, std::sqrt(squares / inside), 0.015);
}

}  // namespace
}  // namespace tandem::test
