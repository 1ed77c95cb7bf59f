// Steps of a liquid that sloshes in a box of walls:
//   bench_liquid BACKEND EDGE STEPS [mixed|double] [box|block|round|shaft|sheet|drum] [scattered]
// EDGE: spacings along each edge of the cube of liquid. In a box; with a block in it; in a round tank as
// wide; in one with a shaft; in a box with a drum with holes, a sheet or half a spacing thick. scattered: the
// particles are in random order, as in a liquid that has been stirred for long. It prints wall time per step,
// particle-steps per second and new lists, without those of the first tenth of the steps.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/io/wall_meshes.hpp"
#include "tests/benchmark/sph/drum_mesh.hpp"

namespace {

using namespace tandem;

constexpr double size = 1;  // of the cube [m]

// The walls, and whether a point is more than half a spacing from them on the side of the liquid.
struct Vessel {
  std::vector<TriangleMesh> walls;
  std::function<bool(Vec3d, double)> holds;
};
Vessel vessel(const std::string& name, double spacing) {
  const Vec3d middle{size / 2, size / 2, size};
  const auto at_middle = [&](TriangleMesh mesh, double z) {
    return transformed(std::move(mesh), Pose{{middle.x, middle.y, z}, {}});
  };
  const auto round = [&](double radius, double height, const std::vector<std::string>& open) {
    scene::CylinderShape shape;
    shape.radius = radius;
    shape.height = height;
    return sph::faceted(shape, open, 0.05 * spacing).mesh;
  };
  const auto from_axis = [middle](Vec3d x) { return std::hypot(x.x - middle.x, x.y - middle.y); };
  constexpr double edge = 0.3, shaft = 0.1;  // [m]
  if (name == "box")
    return {{at_middle(box_mesh({size, size, 2 * size}, {"+z"}), size)}, [](Vec3d, double) { return true; }};
  if (name == "block")
    return {{at_middle(box_mesh({size, size, 2 * size}, {"+z"}), size),
             at_middle(box_mesh({edge, edge, edge}), size / 2)},
            [middle](Vec3d x, double off) {
              return std::max({std::fabs(x.x - middle.x), std::fabs(x.y - middle.y),
                               std::fabs(x.z - size / 2)}) > edge / 2 + off;
            }};
  if (name == "round")
    return {{at_middle(round(size / 2, 2 * size, {"+z"}), size)},
            [from_axis](Vec3d x, double off) { return from_axis(x) < size / 2 - off; }};
  if (name == "shaft")
    return {
        {at_middle(round(size / 2, 2 * size, {"+z"}), size), at_middle(round(shaft, 1.8 * size, {}), size)},
        [from_axis](Vec3d x, double off) {
          const bool beside = from_axis(x) > shaft + off || x.z < 0.1 * size - off;
          return from_axis(x) < size / 2 - off && beside;
        }};
  if (name == "sheet" || name == "drum") {
    const double radius = 0.35 * size, hole = 2 * spacing, pitch = 3 * hole,
                 thickness = name == "drum" ? 0.5 * spacing : 0;
    const int around = static_cast<int>(2 * std::numbers::pi * radius / pitch),
              along = static_cast<int>(0.7 * size / pitch);
    const double low = 0.12 * size, high = low + along * 2 * std::numbers::pi * radius / around;
    return {{at_middle(box_mesh({size, size, 2 * size}, {"+z"}), size),
             at_middle(benchmark::drum(radius, around, along, hole, thickness), low)},
            [=](Vec3d x, double off) {
              const double r = from_axis(x);
              return r < radius - off || r > radius + thickness + off || x.z < low - off || x.z > high + off;
            }};
  }
  throw std::invalid_argument("no vessel '" + name + "': box, block, round, shaft, sheet or drum");
}

void run(const std::string& backend, int edge, int steps, bool single, const std::string& name,
         bool scattered) {
  constexpr double g = 9.81;
  sph::LiquidSetup setup;
  sph::Liquid& l = setup.liquid;
  l.spacing = size / edge;
  l.gravity = {0, 0, -g};
  l.sound_speed = sph::suggested_sound_speed(1, g, size);
  l.artificial = 0.02;
  setup.backend = particles::choose_backend(backend);
  setup.threads = 0;
  const Vessel in = vessel(name, l.spacing);
  setup.walls = in.walls;
  const double outside = 2 * l.spacing;
  setup.domain = {{-outside, -outside, -outside}, {size + outside, size + outside, 2 * size}};
  sph::LiquidState start;
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const Vec3d x = l.spacing * Vec3d{i + 0.5, j + 0.5, k + 0.5};
        if (!in.holds(x, 0.45 * l.spacing)) continue;
        start.position.push_back(x);
        // Of a potential that no wall but the surface cuts.
        constexpr double wave = 3.14159265358979;
        start.velocity.push_back(std::exp(wave * (x.z - size)) *
                                 Vec3d{std::sin(wave * x.x), 0, -std::cos(wave * x.x)});
        start.compression.push_back(sph::compression_at(g * (size - x.z) / (l.sound_speed * l.sound_speed)));
      }
  std::mt19937 bits(1);
  for (std::size_t i = start.size(); scattered && --i > 0;) {
    const std::size_t k = bits() % (i + 1);
    std::swap(start.position[i], start.position[k]);
    std::swap(start.velocity[i], start.velocity[k]);
    std::swap(start.compression[i], start.compression[k]);
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
      "%s %s %s: %zu particles, %.1f us per step, %.4g particle-steps/s, %llu new lists in %d steps, fastest "
      "%.3g "
      "m/s, %llu passed walls\n",
      backend.c_str(), single ? "mixed" : "double", name.c_str(), start.size(),
      1e6 * seconds / (steps - first), static_cast<double>(start.size()) * (steps - first) / seconds,
      static_cast<unsigned long long>(figures.rebuilds - rebuilds), steps - first, figures.largest_speed,
      static_cast<unsigned long long>(figures.passed_walls));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: bench_liquid BACKEND EDGE STEPS [mixed|double] [VESSEL] [scattered]\n");
    return 2;
  }
  try {
    run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), argc < 5 || std::string(argv[4]) != "double",
        argc < 6 ? "box" : argv[5], argc > 6 && std::string(argv[6]) == "scattered");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
