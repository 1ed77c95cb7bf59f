// Steps of a liquid that sloshes in a box of walls:
//   bench_liquid BACKEND EDGE STEPS [double]
// EDGE: spacings along each edge of the cube of liquid. It prints wall time per step, particle-steps per
// second and new lists, without those of the first tenth of the steps.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/equations/time_step.hpp"

namespace {

using namespace tandem;

void run(const std::string& backend, int edge, int steps, bool single) {
  constexpr double g = 9.81, size = 1;
  sph::LiquidSetup setup;
  sph::Liquid& l = setup.liquid;
  l.spacing = size / edge;
  l.gravity = {0, 0, -g};
  l.sound_speed = sph::suggested_sound_speed(1, g, size);
  l.artificial = 0.02;
  setup.backend = particles::choose_backend(backend);
  setup.threads = 0;
  setup.walls = {transformed(box_mesh({size, size, 2 * size}, {"+z"}), Pose{{size / 2, size / 2, size}, {}})};
  setup.domain = {{-l.spacing, -l.spacing, -l.spacing}, {size + l.spacing, size + l.spacing, 2 * size}};
  sph::LiquidState start;
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const Vec3d x = l.spacing * Vec3d{i + 0.5, j + 0.5, k + 0.5};
        start.position.push_back(x);
        // Of a potential that no wall but the surface cuts.
        constexpr double wave = 3.14159265358979;
        start.velocity.push_back(std::exp(wave * (x.z - size)) *
                                 Vec3d{std::sin(wave * x.x), 0, -std::cos(wave * x.x)});
        start.compression.push_back(sph::compression_at(g * (size - x.z) / (l.sound_speed * l.sound_speed)));
      }
  const auto engine = sph::make_liquid_engine(setup, single);
  engine->set_state(start);
  const double dt = 0.9 * sph::step_limits(l, 2, 4 * g).smallest;
  const int first = steps / 10;
  std::uint64_t rebuilds = 0;
  std::chrono::steady_clock::time_point begin;
  for (int k = 0; k < steps; ++k) {
    if (k == first) {
      begin = std::chrono::steady_clock::now();
      rebuilds = engine->figures().rebuilds;
    }
    engine->step(dt);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const sph::StepFigures figures = engine->figures();
  std::printf(
      "%s %s: %zu particles, %.1f us per step, %.4g particle-steps/s, %llu new lists in %d steps, fastest "
      "%.3g "
      "m/s, %llu passed walls\n",
      backend.c_str(), single ? "mixed" : "double", start.size(), 1e6 * seconds / (steps - first),
      static_cast<double>(start.size()) * (steps - first) / seconds,
      static_cast<unsigned long long>(figures.rebuilds - rebuilds), steps - first, figures.largest_speed,
      static_cast<unsigned long long>(figures.passed_walls));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: bench_liquid BACKEND EDGE STEPS [double]\n");
    return 2;
  }
  try {
    run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), argc < 5);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
