// A liquid on a CUDA device and on the CPU. launch/test_device runs these tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/benchmark/sph/drum_mesh.hpp"

namespace tandem::test {
namespace liquid_back_ends_test {

using namespace sph;
using particles::Backend;
constexpr double g = 9.81;  // [m/s2]

// Everything that an engine needs to go on.
using Arrays = std::map<std::string, std::vector<std::byte>>;
Arrays arrays_of(const LiquidEngine& engine) {
  Arrays arrays;
  engine.write([&](const std::string& name, std::span<const std::byte> bytes) {
    arrays[name].assign(bytes.begin(), bytes.end());
  });
  return arrays;
}
void expect_equal(const LiquidEngine& a, const LiquidEngine& b) {
  const Arrays of_a = arrays_of(a), of_b = arrays_of(b);
  ASSERT_EQ(of_a.size(), of_b.size());
  // The elements of one array have bytes without a value.
  for (const auto& [name, bytes] : of_a) {
    if (name == "velocity") continue;
    EXPECT_TRUE(of_b.at(name) == bytes) << name;
  }
  EXPECT_EQ(a.state().velocity, b.state().velocity);
}

struct Case {
  LiquidSetup setup;
  LiquidState start;

  void add(Vec3d x, Vec3d v, double pressure) {
    const Liquid& l = setup.liquid;
    start.position.push_back(x);
    start.velocity.push_back(v);
    start.compression.push_back(compression_at(pressure / (l.density * l.sound_speed * l.sound_speed)));
  }
  std::unique_ptr<LiquidEngine> engine(Backend backend, bool single = true) const {
    LiquidSetup on = setup;
    on.backend = backend;
    return make_liquid_engine(on, single);
  }
};

// A viscous liquid in a periodic box, with random velocities.
Case without_walls() {
  Case c;
  Liquid& l = c.setup.liquid;
  l.density = 1;
  l.viscosity = 0.01;
  l.spacing = 0.05;
  l.sound_speed = 10;
  l.artificial = 0.05;
  l.shifting = 5;
  c.setup.domain = {{0, 0, 0}, {1, 1, 0.5}};
  c.setup.periods.length = c.setup.domain.max;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i)
        c.add(0.05 * Vec3d{i + 0.5 + 0.2 * any(random), j + 0.5 + 0.2 * any(random), k + 0.5},
              {any(random), any(random), any(random)}, 0.5);
  return c;
}

// A tank of water with a sheet without thickness that turns in it.
struct Tank : Case {
  static constexpr double edge = 0.2;  // [m]
  Tank() {
    Liquid& l = setup.liquid;
    l.spacing = edge / 10;
    l.gravity = {0, 0, -g};
    l.sound_speed = suggested_sound_speed(0.5, g, edge);
    l.artificial = 0.1;
    setup.walls.push_back(transformed(box_mesh({2 * edge, edge, 2 * edge}, {"+z"}), Pose{{0, 0, edge}, {}}));
    TriangleMesh sheet;
    sheet.vertices = {{0, -0.3 * edge, -0.3 * edge},
                      {0, 0.3 * edge, -0.3 * edge},
                      {0, 0.3 * edge, 0.3 * edge},
                      {0, -0.3 * edge, 0.3 * edge}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    setup.walls.push_back(sheet);
    setup.domain = {{-edge - l.spacing, -edge, -l.spacing}, {edge + l.spacing, edge, 2 * edge}};
    for (int k = 0; k < 10; ++k)
      for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 20; ++i)
          add({(i - 9.5) * l.spacing, (j - 4.5) * l.spacing, (k + 0.5) * l.spacing}, {},
              l.density * g * (9.5 - k) * l.spacing);
  }
  std::vector<particles::BodyPose> poses(double t) const {
    constexpr double rate = 1;  // about z [rad/s]
    const Quat q = exp(Vec3d{0, 0, rate * t});
    return {{{}, Mat3d::identity(), {}, {}}, {{0, 0, 0.5 * edge}, q.matrix(), {}, {0, 0, rate}}};
  }
  double dt() const { return 0.5 * step_limits(setup.liquid, 1, g).smallest; }
  void advance(LiquidEngine& engine, int from, int steps) const {
    for (int k = from; k < from + steps; ++k) engine.step(dt(), poses((k + 1) * dt()));
  }
};

TEST(LiquidBackEnds, GiveTheSameBitsWithoutWalls) {
  const Case c = without_walls();
  for (const bool single : {true, false}) {
    const auto cpu = c.engine(Backend::cpu, single), cuda = c.engine(Backend::cuda, single);
    for (LiquidEngine* engine : {cpu.get(), cuda.get()}) {
      engine->set_state(c.start);
      for (int k = 0; k < 60; ++k) engine->step(2e-4);
    }
    EXPECT_GT(cuda->figures().rebuilds, 2u);
    expect_equal(*cpu, *cuda);
    EXPECT_EQ(cpu->energies().kinetic, cuda->energies().kinetic);
    EXPECT_EQ(cpu->volume(), cuda->volume());
  }
}

// A drum with holes turns in a box of stirred water: particles near it are pushed by one wall, by two or by
// none, so that threads of a warp part. What bodies feel is what particles feel, in each step.
TEST(LiquidOnCuda, LoadsOfBodiesAreWhatParticlesFeel) {
  constexpr int edge = 80, steps = 100;
  constexpr double spin = 6, drum_radius = 0.35, low = 0.12;
  Case c;
  Liquid& l = c.setup.liquid;
  l.spacing = 1.0 / edge;
  l.gravity = {0, 0, -g};
  l.sound_speed = 30;
  l.artificial = 0.05;
  const double hole = 2 * l.spacing, pitch = 3 * hole, thickness = 0.6 * l.spacing, off = 0.45 * l.spacing;
  const int around = static_cast<int>(2 * std::numbers::pi * drum_radius / pitch),
            along = static_cast<int>(0.7 / pitch);
  const double high = low + along * 2 * std::numbers::pi * drum_radius / around;
  c.setup.walls = {transformed(box_mesh({1, 1, 2}, {"+z"}), Pose{{0.5, 0.5, 1}, {}}),
                   benchmark::drum(drum_radius, around, along, hole, thickness)};
  c.setup.domain = {{-0.2, -0.2, -0.2}, {1.2, 1.2, 2}};
  const auto poses = [&](double t) {
    const Quat q = exp(Vec3d{0, 0, spin * t});
    return std::vector<particles::BodyPose>{{{}, Mat3d::identity(), {}, {}},
                                            {{0.5, 0.5, low}, q.matrix(), {}, {0, 0, spin}}};
  };
  for (int k = 0; k < edge / 2; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const Vec3d x = l.spacing * Vec3d{i + 0.5, j + 0.5, k + 0.5};
        const double r = std::hypot(x.x - 0.5, x.y - 0.5);
        const bool in_drum =
            r > drum_radius - off && r < drum_radius + thickness + off && x.z > low - off && x.z < high + off;
        if (!in_drum)
          c.add(x, {2 * std::sin(7 * x.y), 2 * std::cos(5 * x.x), 0}, l.density * g * (0.5 - x.z));
      }
  const auto engine = c.engine(Backend::cuda);
  engine->set_state(c.start, poses(0));
  const double weight = static_cast<double>(c.start.size()) * l.mass() * g;
  double t = 0, worst = 0;
  Vec3d before = engine->momentum();
  for (int k = 0; k < steps; ++k) {
    const StepFigures f = engine->figures();
    const double dt =
        0.9 *
        step_limits(l, std::max(3.0, f.largest_speed), std::max(4 * g, f.largest_acceleration)).smallest;
    t += dt;
    engine->step(dt, poses(t));
    const Vec3d lost = engine->take_lost().momentum;
    Vec3d impulse = dt * weight / g * l.gravity;
    for (const Wrench& load : engine->step_loads()) impulse -= dt * load.force;
    const Vec3d now = engine->momentum();
    worst = std::max(worst, norm(now - before - impulse + lost) / (weight * dt));
    before = now;
  }
  std::printf("momentum of %zu particles over %d steps: off by %.2g of the weight (wanted: 1e-9)\n",
              c.start.size(), steps, worst);
  EXPECT_LT(worst, 1e-9);
}

TEST(LiquidBackEnds, GiveTheSameBitsBesideWalls) {
  const Tank tank;
  for (const bool single : {true, false}) {
    const auto cpu = tank.engine(Backend::cpu, single), cuda = tank.engine(Backend::cuda, single);
    for (LiquidEngine* engine : {cpu.get(), cuda.get()}) {
      engine->set_state(tank.start, tank.poses(0));
      tank.advance(*engine, 0, 40);
    }
    EXPECT_GT(norm(cuda->loads()[1].force), 0);
    EXPECT_EQ(cuda->figures().passed_walls, 0u);
    expect_equal(*cpu, *cuda);
  }
}

TEST(LiquidOnCuda, RepeatsItsBits) {
  const Tank tank;
  const auto once = tank.engine(Backend::cuda), again = tank.engine(Backend::cuda);
  setenv("TANDEM_CUDA_BLOCK", "32", 1);
  const auto small_blocks = tank.engine(Backend::cuda);
  unsetenv("TANDEM_CUDA_BLOCK");
  for (LiquidEngine* engine : {once.get(), again.get(), small_blocks.get()}) {
    engine->set_state(tank.start, tank.poses(0));
    tank.advance(*engine, 0, 60);
  }
  expect_equal(*once, *again);
  expect_equal(*once, *small_blocks);
}

TEST(LiquidOnCuda, GoesOnWithTheSameBits) {
  const Tank tank;
  const auto straight = tank.engine(Backend::cuda), back = tank.engine(Backend::cuda),
             read = tank.engine(Backend::cuda);
  for (LiquidEngine* engine : {straight.get(), back.get()}) {
    engine->set_state(tank.start, tank.poses(0));
    tank.advance(*engine, 0, 33);
  }
  back->save();
  const Arrays at_33 = arrays_of(*straight);
  tank.advance(*straight, 33, 40);
  tank.advance(*back, 33, 17);
  back->restore();
  tank.advance(*back, 33, 40);
  expect_equal(*straight, *back);
  read->set_state(tank.start, tank.poses(0));
  read->read(
      [&](const std::string& name) {
        const auto found = at_33.find(name);
        return found == at_33.end() ? std::vector<std::byte>{} : found->second;
      },
      tank.start.size());
  tank.advance(*read, 33, 40);
  expect_equal(*straight, *read);
}

TEST(LiquidOnCuda, ExchangesParticlesAsTheCpuDoes) {
  const Case c = without_walls();
  const auto cpu = c.engine(Backend::cpu), cuda = c.engine(Backend::cuda);
  LiquidState arriving;
  arriving.position = {{0.512, 0.48, 0.26}, {0.1, 0.9, 0.4}};
  arriving.velocity = {{1, 0, 0}, {0, 1, 0}};
  arriving.compression = {0, 0.001};
  const std::vector<std::uint32_t> leaving{0, 17, 2100, 3999};
  for (LiquidEngine* engine : {cpu.get(), cuda.get()}) {
    engine->set_state(c.start);
    for (int k = 0; k < 10; ++k) engine->step(1e-4);
    engine->exchange(leaving, arriving, engine->poses());
    for (int k = 0; k < 10; ++k) engine->step(1e-4);
  }
  EXPECT_EQ(cuda->state().size(), c.start.size() - 2);
  expect_equal(*cpu, *cuda);
}

// A cloud that flies apart, seen from a vessel that moves.
TEST(LiquidOnCuda, LosesParticlesAsTheCpuDoes) {
  Case c = without_walls();
  c.setup.periods = {};
  c.setup.walls = {transformed(box_mesh({0.1, 0.1, 0.1}), Pose{{5, 5, 5}, {}})};
  c.setup.vessel = Vessel{0, {5, 5, 5}};
  c.setup.follows = 0;
  const Vec3d velocity{0.3, 0.2, -0.1};
  const auto poses = [&](double t) {
    return std::vector<particles::BodyPose>{{t * velocity, Mat3d::identity(), velocity, {}}};
  };
  for (const bool single : {true, false}) {
    const auto cpu = c.engine(Backend::cpu, single), cuda = c.engine(Backend::cuda, single);
    cpu->set_state(c.start, poses(0));
    cuda->set_state(c.start, poses(0));
    std::size_t lost = 0;
    for (int k = 1; k <= 300; ++k) {
      cpu->step(2e-4, poses(k * 2e-4));
      cuda->step(2e-4, poses(k * 2e-4));
      const LostParticles a = cpu->take_lost(), b = cuda->take_lost();
      ASSERT_EQ(a.index, b.index) << "step " << k;
      EXPECT_EQ(a.momentum, b.momentum);
      EXPECT_EQ(a.energy, b.energy);
      lost += a.index.size();
    }
    EXPECT_GT(lost, 100u);
    EXPECT_EQ(cuda->state().size(), c.start.size() - lost);
    expect_equal(*cpu, *cuda);
  }
}

// A mug with eight sides, which no lattice fits.
TEST(LiquidOnCuda, FillsAsTheCpuDoes) {
  LiquidSetup setup;
  setup.liquid.spacing = 0.01;
  setup.liquid.gravity = {0, 0, -g};
  setup.liquid.sound_speed = suggested_sound_speed(0, g, 0.083);
  const Pose middle{{0, 0, 0.06}, {}};
  setup.walls = {transformed(cylinder_mesh(0.05, 0.12, 8, {"+z"}), middle)};
  setup.domain = {{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.2}};
  const std::vector<particles::BodyPose> poses{{{}, Mat3d::identity(), {}, {}}};
  const Filling filling{transformed(cylinder_mesh(0.05, 0.12, 8), middle), {0.083, {}}};
  const FilledPlaces on_cpu = fill_places(setup, poses, filling);
  setup.backend = Backend::cuda;
  EXPECT_TRUE(on_cpu.relaxed);
  EXPECT_EQ(fill_places(setup, poses, filling).position, on_cpu.position);
}

}  // namespace liquid_back_ends_test
}  // namespace tandem::test
