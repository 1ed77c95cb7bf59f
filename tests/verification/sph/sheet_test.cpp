// A sheet without thickness, with liquid on one side and on both.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sph_server/equations/time_step.hpp"
#include "tests/support/error_of.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace sheet_test {

using namespace sph;

TriangleMesh rectangle(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  TriangleMesh m;
  m.vertices = {a, b, c, d};
  m.triangles = {{0, 1, 2}, {0, 2, 3}};
  return m;
}

// A cube of liquid flies against a sheet at a tenth of the speed of sound.
struct Jet {
  static constexpr int edge = 6;
  static constexpr double sound_speed = 30, speed = 0.1 * sound_speed, size = edge * 0.01;  // [m/s], [m]
  LiquidSetup setup;
  LiquidState start;
  Jet() {
    Liquid& l = setup.liquid;
    l.spacing = size / edge;
    l.sound_speed = sound_speed;
    l.artificial = 0.05;
    setup.walls = {rectangle({0, -2, -2}, {0, 2, -2}, {0, 2, 2}, {0, -2, 2})};
    setup.domain = {{-1, -1, -1}, {1, 1, 1}};
    for (int k = 0; k < edge * edge * edge; ++k) {
      start.position.push_back(l.spacing *
                                   Vec3d{k % edge + 1.0, k / edge % edge + 0.5, k / edge / edge + 0.5} -
                               Vec3d{0, size / 2, size / 2});
      start.velocity.push_back({-speed, 0, 0});
      start.compression.push_back(0);
    }
  }
  double step() const { return step_limits(setup.liquid, 2 * speed, 0).smallest; }  // [s]
};

TEST(Sheet, StopsALiquidAtATenthOfTheSpeedOfSound) {
  const Jet jet;
  const double a = Jet::size, speed = Jet::speed;
  const LiquidState& start = jet.start;
  const auto engine = make_engine(jet.setup, true);
  engine->set_state(start);
  const EnergyBalance begin = engine->energies();
  const double dt = jet.step(), mass = jet.setup.liquid.mass();
  double compressed = 0;
  Vec3d impulse, previous = engine->loads()[0].force;
  for (double t = 0; t < 1.5 * a / speed; t += dt) {
    // The step extrapolates the forces of two steps, as Adams and Bashforth do.
    const Vec3d now = engine->loads()[0].force;
    impulse += dt * (1.5 * now - 0.5 * previous);
    previous = now;
    engine->step(dt);
    compressed = std::max(compressed, engine->figures().largest_compression);
  }
  const LiquidState end = engine->state();
  Vec3d momentum;
  double behind = 0;
  for (std::size_t i = 0; i < end.size(); ++i) {
    momentum += mass * (end.velocity[i] - start.velocity[i]);
    behind += end.position[i].x < 0 ? 1 : 0;
  }
  const EnergyBalance balance = engine->energies();
  const double all = static_cast<double>(end.size()) * mass * speed;
  std::printf("a cube of %d particles flies against a sheet at %.0f m/s\n", Jet::edge * Jet::edge * Jet::edge,
              speed);
  expect_figure("particles behind the sheet", 0, behind, 0);
  EXPECT_GT(compressed, 0.05) << "the liquid must have been stopped hard";
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  std::printf("  impulse of the liquid on the sheet / its momentum %.3f\n", -impulse.x / all);
  expect_figure("impulses on liquid and sheet / momentum", 0, norm(momentum + impulse) / all, 1e-12);
  const double change = balance.kinetic + balance.compression - begin.kinetic - begin.compression;
  std::printf("  energy / start: kinetic %.4f, compression %.4f, viscosity %.4f, bulk %.4f, diffusion %.4f\n",
              balance.kinetic / begin.kinetic, balance.compression / begin.kinetic,
              balance.viscosity / begin.kinetic, balance.bulk_viscosity / begin.kinetic,
              balance.diffusion / begin.kinetic);
  expect_figure("(change of energy - works) / start", 0, (change - balance.changes()) / begin.kinetic, 0.01);
}

TEST(Sheet, GetsTheSameBitsFromEveryNumberOfThreads) {
  for (const bool single : {false, true}) {
    std::vector<LiquidState> ends;
    std::vector<Vec3d> torques;
    for (const unsigned threads : {1u, 2u, 3u}) {
      Jet jet;
      jet.setup.threads = threads;
      const auto engine = make_engine(jet.setup, single);
      engine->set_state(jet.start);
      for (int k = 0; k < 60; ++k) engine->step(jet.step());
      EXPECT_GT(norm(engine->loads()[0].force), 0) << "the liquid must have come to the sheet";
      ends.push_back(engine->state());
      torques.push_back(engine->loads()[0].torque);
      EXPECT_EQ(ends.back().position, ends.front().position);
      EXPECT_EQ(ends.back().compression, ends.front().compression);
      EXPECT_EQ(torques.back(), torques.front());
    }
  }
}

TEST(Liquid, RefusesAStepThatIsTooLong) {
  const Jet jet;
  const auto engine = make_engine(jet.setup, true);
  engine->set_state(jet.start);
  const double longest = step_limits(jet.setup.liquid, Jet::speed, 0).smallest;
  EXPECT_EQ(error_of([&] { engine->step(1.01 * longest); }),
            "numerics: liquid: a step of 0.000137727 s, where sound and speed allow 0.000136364 s, viscosity "
            "inf s and "
            "acceleration inf s (take a step of at most the smallest of them)");
  EXPECT_EQ(error_of([&] { engine->step(longest); }), "no error");
}

// Sums of integers would show some number in place of one that is none.
TEST(Liquid, RefusesSumsOverAStateThatIsNone) {
  for (const bool fast : {true, false}) {
    Jet jet;
    (fast ? jet.start.velocity[0].x : jet.start.compression[0]) = fast ? std::nan("") : 1.5;
    const auto engine = make_engine(jet.setup, false);
    const auto sums = [&] {
      engine->set_state(jet.start);
      engine->energies();
    };
    EXPECT_NE(error_of(sums).find("the liquid flies apart: "), std::string::npos);
  }
}

// A box, 12 x 6 spacings, with a sheet in its middle that stands on the floor and touches the sides.
TEST(Sheet, KeepsTwoLevelsApart) {
  constexpr int across = 12, deep = 6, high = 12, low = 6;
  constexpr double g = 9.81;
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  const double depth = 1.2;
  l.spacing = depth / high;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(0, g, depth);
  l.artificial = 0.1;
  const double width = across * l.spacing, breadth = deep * l.spacing, c2 = l.sound_speed * l.sound_speed;
  setup.walls = {
      transformed(box_mesh({width, breadth, 2 * depth}, {"+z"}), Pose{{width / 2, breadth / 2, depth}, {}}),
      rectangle({width / 2, 0, 0}, {width / 2, breadth, 0}, {width / 2, breadth, 2 * depth},
                {width / 2, 0, 2 * depth})};
  setup.domain = {{-l.spacing, -l.spacing, -l.spacing}, {width + l.spacing, breadth + l.spacing, 2 * depth}};
  LiquidState start;
  const auto compressed = [&](double d) { return c2 / g * std::log(1 + g * d / c2); };
  for (int k = 0; k < high; ++k)
    for (int j = 0; j < deep; ++j)
      for (int i = 0; i < across; ++i) {
        const int levels = i < across / 2 ? high : low;
        if (k >= levels) continue;
        const double above = (levels - k - 0.5) * l.spacing;
        start.position.push_back({(i + 0.5) * l.spacing, (j + 0.5) * l.spacing,
                                  compressed(levels * l.spacing) - compressed(above)});
        start.velocity.push_back({});
        start.compression.push_back(std::pow(1 + 7 * g * above / c2, 1.0 / 7) - 1);
      }
  const auto engine = make_engine(setup, true);
  engine->set_state(start);
  const double weight = static_cast<double>(start.size()) * l.mass() * g, potential = weight * depth / 3;
  const double dt = step_limits(l, 0.1 * l.sound_speed, 0).smallest;
  const int steps = static_cast<int>(1.2 / dt);
  double load = 0, side = 0, late = 0;
  int counted = 0;
  for (int k = 0; k < steps; ++k) {
    engine->step(dt);
    if (k < steps / 2) continue;
    const auto loads = engine->loads();
    load += loads[0].force.z + loads[1].force.z;
    side += loads[1].force.x;
    late = std::max(late, engine->energies().kinetic / potential);
    ++counted;
  }
  double crossed = 0;
  const LiquidState end = engine->state();
  for (std::size_t i = 0; i < end.size(); ++i)
    crossed += (end.position[i].x < width / 2) != (start.position[i].x < width / 2) ? 1 : 0;
  std::printf("a sheet between levels of %d and %d spacings\n", high, low);
  expect_figure("particles that crossed the sheet", 0, crossed, 0);
  expect_figure("load on box and sheet / weight", 1, -load / counted / weight, 5e-4);
  expect_figure("kinetic / potential energy after 0.6 s", 0, late, 1e-6);
  // Half the product of the pressure at the bottom and the wetted area, of either side.
  const double force =
      0.5 * 1000 * g * breadth * (depth * compressed(depth) - low * l.spacing * compressed(low * l.spacing));
  expect_figure("force on the sheet / hydrostatic difference", 1, side / counted / force, 0.01);
}

}  // namespace sheet_test
}  // namespace tandem::test
