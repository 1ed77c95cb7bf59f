// The floor of a vessel is two bodies that continue each other in one plane. Each carries half of the weight,
// and nothing along the plane.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "sph_server/equations/hydrostatic.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace split_floor_test {

using namespace sph;

// Of `across` x `along` pairs of triangles.
TriangleMesh rectangle(double low, double high, int across, int along) {
  TriangleMesh m;
  for (int k = 0; k < across * along; ++k) {
    const double dx = (high - low) / across, dy = 5.0 / along, x = low + dx * (k % across),
                 y = -2 + dy * (k / across);
    const auto first = static_cast<std::uint32_t>(m.vertices.size());
    m.vertices.insert(m.vertices.end(), {{x, y, 0}, {x + dx, y, 0}, {x + dx, y + dy, 0}, {x, y + dy, 0}});
    m.triangles.push_back({first, first + 1, first + 2});
    m.triangles.push_back({first, first + 2, first + 3});
  }
  return m;
}

// Loads on the halves at the start.
void push(int across, int along) {
  constexpr int wide = 10, high = 8;
  constexpr double a = 0.1, width = wide * a, g = 9.81;
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = a;
  l.gravity = {0, 0, -g};
  l.sound_speed = 10 * std::sqrt(g * high * a);
  TriangleMesh sides;
  for (const double x : {0.0, width}) {
    const auto first = static_cast<std::uint32_t>(sides.vertices.size());
    sides.vertices.insert(sides.vertices.end(), {{x, -2, 0}, {x, 3, 0}, {x, 3, 3}, {x, -2, 3}});
    sides.triangles.push_back({first, first + 1, first + 2});
    sides.triangles.push_back({first, first + 2, first + 3});
  }
  setup.walls = {sides, rectangle(0, 0.5 * width, across, along),
                 rectangle(0.5 * width, width, across, along)};
  setup.slip = {true, true, true};
  setup.domain = {{-1, 0, -1}, {2, width, 3}};
  setup.periods.min = setup.domain.min;
  setup.periods.length = {0, width, 0};
  LiquidState start;
  for (int k = 0; k < wide * wide * high; ++k) {
    const double z = k / wide / wide + 0.5;
    start.position.push_back(a * Vec3d{k % wide + 0.5, k / wide % wide + 0.5, z});
    start.velocity.push_back({});
    start.compression.push_back(at_rest(l, (high - z) * a).compression);
  }
  const auto engine = make_engine(setup, true);
  engine->set_state(start);
  const auto loads = engine->loads();
  std::printf("halves of %d triangles\n", 2 * across * along);
  const double half = 0.5 * static_cast<double>(start.size()) * l.mass() * g;
  for (const std::size_t floor : {1u, 2u}) {
    expect_figure("load across the plane / half the weight", -1, loads[floor].force.z / half, 0.02);
    expect_figure("load along the plane / half the weight", 0, loads[floor].force.x / half, 0.005);
  }
}

TEST(SplitFloor, PushesItsHalvesNeitherTogetherNorApart) {
  push(1, 1);
  push(7, 7);
  push(25, 16);  // a fifth of a spacing across the edge
}

}  // namespace split_floor_test
}  // namespace tandem::test
