// Flows of a liquid in periodic boxes, without walls: closed forms, momentum, energy, equal bits.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace periodic_flow_test {

using namespace sph;

// The vortices of Taylor and Green, uniform along z: v = U exp(-2 nu k^2 t) (sin kx cos ky, -cos kx sin ky,
// 0).
struct Vortices {
  static constexpr double length = 1, speed = 1, density = 1;  // [m], [m/s], [kg/m3]
  static constexpr double viscosity = 0.02;                    // Reynolds number 50
  LiquidSetup setup;
  LiquidState start;

  explicit Vortices(int across) {
    Liquid& l = setup.liquid;
    l.density = density;
    l.viscosity = viscosity;
    l.spacing = length / across;
    l.sound_speed = suggested_sound_speed(speed, 0, 0);
    const int deep = 10;
    setup.domain = {{0, 0, 0}, {length, length, deep * l.spacing}};
    setup.periods.length = setup.domain.max;
    const double k = 2 * std::numbers::pi / length;
    for (int z = 0; z < deep; ++z)
      for (int y = 0; y < across; ++y)
        for (int x = 0; x < across; ++x) {
          const Vec3d at = l.spacing * Vec3d{x + 0.5, y + 0.5, z + 0.5};
          start.position.push_back(at);
          start.velocity.push_back({speed * std::sin(k * at.x) * std::cos(k * at.y),
                                    -speed * std::cos(k * at.x) * std::sin(k * at.y), 0});
          // Pressure of the incompressible flow.
          const double p = density * speed * speed / 4 * (std::cos(2 * k * at.x) + std::cos(2 * k * at.y));
          start.compression.push_back(p / (density * l.sound_speed * l.sound_speed));
        }
  }
  double decay(double t) const {  // of the kinetic energy
    const double k = 2 * std::numbers::pi / length;
    return std::exp(-4 * viscosity / density * k * k * t);
  }
};

Vec3d momentum(const LiquidState& s, double mass) {
  Vec3d sum;
  for (const Vec3d& v : s.velocity) sum += mass * v;
  return sum;
}

// The particles start on a cubic lattice. Along the stretched axes of the vortices this lattice would break
// up at t = 0.12 s without shifting, and the flow would then lose energy too fast.
void decay_of_vortices(bool single) {
  Vortices flow(20);
  flow.setup.liquid.shifting = 5;
  const auto engine = make_engine(flow.setup, single);
  engine->set_state(flow.start);
  const double mass = flow.setup.liquid.mass(),
               dt = step_limits(flow.setup.liquid, Vortices::speed, 0).smallest;
  const EnergyBalance begin = engine->energies();
  double t = 0, worst_pair = 0;
  for (; t < 0.3; t += dt) {
    engine->step(dt);
    worst_pair = std::max(worst_pair, norm(engine->figures().pair_impulse_rate));
  }
  const EnergyBalance end = engine->energies();
  const double all = begin.kinetic;
  std::printf("Taylor-Green vortices, 20 across, %s precision, %.3f s\n", single ? "single" : "double", t);
  expect_figure("kinetic energy / that at the start", flow.decay(t), end.kinetic / all, 0.04);
  expect_figure("sum of all pair forces [N]", 0, worst_pair, 0);
  const double moving = static_cast<double>(flow.start.size()) * mass * Vortices::speed;
  expect_figure("momentum / mass and speed", 0, norm(momentum(engine->state(), mass)) / moving, 1e-13);
  std::printf("  energy: viscosity %.5f, bulk viscosity %.5f, diffusion %.5f of the start\n",
              end.viscosity / all, end.bulk_viscosity / all, end.diffusion / all);
  const double change = end.kinetic + end.compression - begin.kinetic - begin.compression;
  expect_figure("change of energy / sum of the works", 1, change / end.changes(), 0.01);
}

TEST(Vortices, DecayAsTaylorAndGreenSayInDouble) {
  decay_of_vortices(false);
}
TEST(Vortices, DecayAsTaylorAndGreenSayInSingle) {
  decay_of_vortices(true);
}

// A sinusoidal shear flow keeps its lattice: v = U exp(-nu k^2 t) (sin ky, 0, 0).
TEST(ShearWave, DecaysByViscosityAlone) {
  Vortices flow(24);
  const double k = 2 * std::numbers::pi / Vortices::length;
  for (std::size_t i = 0; i < flow.start.size(); ++i) {
    flow.start.velocity[i] = {std::sin(k * flow.start.position[i].y), 0, 0};
    flow.start.compression[i] = 0;
  }
  const auto engine = make_engine(flow.setup, true);
  engine->set_state(flow.start);
  const double dt = step_limits(flow.setup.liquid, Vortices::speed, 0).smallest;
  const EnergyBalance begin = engine->energies();
  double t = 0;
  for (; t < 0.1; t += dt) engine->step(dt);
  const EnergyBalance end = engine->energies();
  std::printf("shear wave, 24 across\n");
  expect_figure("kinetic energy / that at the start",
                std::exp(-2 * Vortices::viscosity / Vortices::density * k * k * t),
                end.kinetic / begin.kinetic, 0.005);
}

TEST(Vortices, HaveTheSameBitsForEveryNumberOfThreads) {
  for (const bool single : {false, true}) {
    std::vector<LiquidState> ends;
    for (const unsigned threads : {1u, 2u, 3u}) {
      Vortices flow(12);
      flow.setup.threads = threads;
      const auto engine = make_engine(flow.setup, single);
      engine->set_state(flow.start);
      for (int k = 0; k < 60; ++k) engine->step(step_limits(flow.setup.liquid, Vortices::speed, 0).smallest);
      ends.push_back(engine->state());
      EXPECT_EQ(ends.back().position, ends.front().position);
      EXPECT_EQ(ends.back().velocity, ends.front().velocity);
      EXPECT_EQ(ends.back().compression, ends.front().compression);
      EXPECT_GT(engine->figures().rebuilds, 1u) << "the lists must have been built anew";
    }
  }
}

}  // namespace periodic_flow_test
}  // namespace tandem::test
