// Time of a micro step of a bed on 1, 2, ... ranks with a GPU each, which are threads of this process here:
//
//   bench_rank_gpus BED SPHERES_OF_A_RANK RANKS SETTLE STEPS [strong]
//
// BED: settled, a block in a box that has come to rest, or flowing, a block that collapses into a box of
// three times its width. With `strong` the spheres are those of all ranks together. Prints one row for each
// number of ranks up to RANKS, with the hash of the state where all of them have the same spheres.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/thread_ranks.hpp"

namespace {

using namespace tandem;

constexpr double spacing = 0.0202;  // [m]

// `side`: spheres across the block in y and z. `wide`: of the box, in widths of the block.
std::string bed(std::int64_t spheres, std::int64_t side, double wide) {
  const auto across = static_cast<double>(side);
  const double y = spacing * across, z = y,
               x = spacing * std::ceil(static_cast<double>(spheres) / (across * across)), end = wide * x;
  const auto plane = [](const char* name, const std::string& point, const std::string& normal) {
    return fmt::format(
        R"({{"name": "{}", "material": "glass", "shape": {{"type": "plane", "point": [{}], "normal": [{}]}}}})",
        name, point, normal);
  };
  return fmt::format(
      R"({{"tandem": "1.0", "name": "bed", "end_time": 1.0, "coupling": {{"window": 0.001}},
      "dem": {{"contact": "hertz_mindlin",
        "materials": [{{"name": "glass", "density": 2500, "young": 1e8, "poisson": 0.25}}],
        "pairs": [{{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.4}}],
        "particles": [{{"name": "all", "material": "glass", "radius": 0.01,
          "fill": {{"type": "lattice", "lattice": "cubic", "min": [0, 0, 0], "max": [{0}, {1}, {2}], "spacing": {3}, "jitter": 0.9,
                   "count": {4}}}}}],
        "walls": [{5}, {6}, {7}, {8}, {9}],
        "domain": {{"min": [-0.1, -0.1, -0.1], "max": [{10}, {11}, {12}]}}}},
      "output": {{"particles": false}}}})",
      x + 1e-6, y + 1e-6, z + 1e-6, spacing, spheres, plane("floor", "0,0,0", "0,0,1"),
      plane("left", "0,0,0", "1,0,0"), plane("right", fmt::format("{},0,0", end), "-1,0,0"),
      plane("front", "0,0,0", "0,1,0"), plane("back", fmt::format("0,{},0", y), "0,-1,0"), end + 0.1, y + 0.1,
      z + 0.1);
}

constexpr double dt = 4e-5;  // [s]
constexpr std::uint32_t steps_of_window = 250;

struct Measured {
  double milliseconds = 0;  // of a step
  double rebuilds = 0;      // in all steps
  double imbalance = 1;
  double kinetic_energy = 0;  // of a sphere [J]
  std::string hash;
};

Measured measure(const std::string& json, std::uint32_t settle, std::uint32_t steps, bool hash,
                 particles::Ranks* ranks) {
  test::ParticleRun run(
      json, particles::Backend::cuda, 1, [](particles::Spheres&) {}, {}, ranks);
  const auto advance = [&](std::uint32_t all) -> const dem::WindowOutcome& {
    for (std::uint32_t k = steps_of_window; k < all; k += steps_of_window) run.advance(steps_of_window, dt);
    return run.advance(steps_of_window, dt);
  };
  const auto before = static_cast<double>(advance(settle).window.rebuilds);
  const auto begin = std::chrono::steady_clock::now();
  const dem::WindowOutcome& end = advance(steps);
  Measured found;
  found.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count() / steps;
  found.rebuilds = static_cast<double>(end.window.rebuilds) - before;
  found.kinetic_energy = end.end.kinetic_energy / static_cast<double>(run.spheres.size());
  found.imbalance = run.engine->rank_imbalance();
  if (hash) found.hash = dem::state_hash(run.state());
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    fmt::print("usage: bench_rank_gpus settled|flowing SPHERES RANKS SETTLE STEPS [strong]\n");
    return 2;
  }
  const std::string which = argv[1];
  const std::int64_t spheres = std::atoll(argv[2]);
  const auto most = static_cast<unsigned>(std::atoi(argv[3]));
  const auto settle = static_cast<std::uint32_t>(std::atoi(argv[4])),
             steps = static_cast<std::uint32_t>(std::atoi(argv[5]));
  const bool strong = argc > 6;
  const auto side = static_cast<std::int64_t>(std::llround(std::cbrt(static_cast<double>(spheres))));
  fmt::print(
      "bed,spheres,ranks,devices,ms_per_step,rebuilds,steps,imbalance,kinetic_energy_of_a_sphere_J,hash\n");
  for (unsigned size = 1; size <= most; size *= 2) {
    const std::int64_t all = strong ? spheres : spheres * size;
    const std::string json = bed(all, side, which == "flowing" ? 3 : 1);
    Measured found;
    if (size == 1)
      found = measure(json, settle, steps, strong, nullptr);
    else
      test::on_ranks(size, [&](test::ThreadRanks& ranks) {
        const Measured here = measure(json, settle, steps, strong, &ranks);
        if (ranks.rank() == 0) found = here;
      });
    fmt::print("{},{},{},{},{:.4f},{},{},{:.3f},{:.3e},{}\n", which, all, size, particles::cuda_devices(),
               found.milliseconds, found.rebuilds, steps, found.imbalance, found.kinetic_energy, found.hash);
    std::fflush(stdout);
  }
}
