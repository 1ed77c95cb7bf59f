// A round tank with a shaft that stands on its floor is filled in, and the liquid rests:
//   bench_fill BACKEND ACROSS REST [ARTIFICIAL [THREADS]]
// ACROSS: spacings across the tank: 31 for 20,000 particles, 115 for a million. REST: how long it rests [s].
// ARTIFICIAL: artificial viscosity, 0.1. It prints the times of the filling, on the clock and of all cores,
// and kinetic / potential energy, load / weight and pressure at the bottom / rho g depth as means of the
// second half of the rest.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>

#include "common/cpu_time.hpp"
#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace {

using namespace tandem;
using Clock = std::chrono::steady_clock;

constexpr double g = 9.81, diameter = 1, depth = 0.9;

TriangleMesh with(TriangleMesh mesh, const TriangleMesh& other, bool reverse) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back(reverse ? std::array{first + t[0], first + t[2], first + t[1]}
                                     : std::array{first + t[0], first + t[1], first + t[2]});
  return mesh;
}

void run(const std::string& backend, int across, double rest, double artificial, unsigned threads) {
  sph::LiquidSetup setup;
  sph::Liquid& l = setup.liquid;
  l.spacing = diameter / across;
  l.gravity = {0, 0, -g};
  l.sound_speed = sph::suggested_sound_speed(0, g, depth);
  l.viscosity = 1e-3;
  l.artificial = artificial;
  setup.backend = particles::choose_backend(backend);
  setup.threads = threads;
  constexpr double height = 1.2;
  constexpr int segments = 48;
  const Pose middle{{0, 0, 0.5 * height}, {}};
  const TriangleMesh shaft = transformed(cylinder_mesh(0.125 * diameter, height, segments / 2),
                                         Pose{{0.04, 0.01, 0.5 * height}, {}});
  setup.walls = {
      with(transformed(cylinder_mesh(0.5 * diameter, height, segments, {"+z"}), middle), shaft, false)};
  setup.domain = {{-1, -1, -0.5}, {1, 1, 2}};
  const sph::Filling filling{
      with(transformed(cylinder_mesh(0.5 * diameter, height, segments), middle), shaft, true),
      {depth, {}, {}}};
  const std::vector<particles::BodyPose> poses{{{}, Mat3d::identity(), {}, {}}};
  const Clock::time_point begin = Clock::now();
  const double cpu = cpu_seconds(CpuClock::process);
  double first_step = 0;
  const sph::FilledPlaces filled = sph::fill_places(setup, poses, filling, [&](int done, int) {
    if (done == 1) first_step = std::chrono::duration<double>(Clock::now() - begin).count();
  });
  std::printf(
      "%s: %zu particles filled in within %.2f s, %.2f s of it until the first step; %.2f s of all cores\n",
      backend.c_str(), filled.position.size(), std::chrono::duration<double>(Clock::now() - begin).count(),
      first_step, cpu_seconds(CpuClock::process) - cpu);
  std::fflush(stdout);
  const auto engine = sph::make_liquid_engine(setup, true);
  engine->set_state(sph::at_rest_in(setup, filling, filled.position), poses);
  const double weight = static_cast<double>(filled.position.size()) * l.mass() * g;
  const sph::Walls walls(setup.walls, l.support());
  double time = 0, load = 0, pressure = 0, next = 0;
  int loads = 0, pressures = 0;
  while (time < rest) {
    const double dt =
        sph::step_limits(l, engine->figures().largest_speed, engine->figures().largest_acceleration).smallest;
    engine->step(dt);
    time += dt;
    if (time > 0.5 * rest) {
      load -= engine->loads()[0].force.z;
      ++loads;
    }
    if (time < next) continue;
    next += 0.05 * rest;
    if (time > 0.5 * rest) {
      pressure +=
          sph::Probe(engine->state(), l, setup.periods, walls).pressure_at({-0.3 * diameter, 0.02, 0});
      ++pressures;
    }
    std::printf("  %6.3f s: kinetic / potential energy %.2e\n", time,
                engine->energies().kinetic / (0.5 * weight * depth));
    std::fflush(stdout);
  }
  if (loads > 0 && pressures > 0)
    std::printf("  load / weight %.5f, pressure at the bottom / rho g depth %.4f, passed walls %llu\n",
                load / loads / weight, pressure / pressures / (l.density * g * depth),
                static_cast<unsigned long long>(engine->figures().passed_walls));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: bench_fill BACKEND ACROSS REST [ARTIFICIAL [THREADS]]\n");
    return 2;
  }
  try {
    run(argv[1], std::atoi(argv[2]), std::atof(argv[3]), argc > 4 ? std::atof(argv[4]) : 0.1,
        argc > 5 ? static_cast<unsigned>(std::atoi(argv[5])) : 0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
