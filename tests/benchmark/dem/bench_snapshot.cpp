// The cost of a rollback: windows of ten micro steps alone, with a save before each, and with a save and a
// restore. A save is an asynchronous copy on a GPU, so that only the time of the window after it shows its
// cost. For a GPU: bench_snapshot --benchmark_filter=cuda
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <memory>

#include "common/error.hpp"
#include "tests/support/particle_run.hpp"

namespace tandem::test {
namespace {

// A lattice of spheres that falls onto a floor.
std::string lattice(std::int64_t spheres) {
  const double width = 0.0205 * std::ceil(std::cbrt(static_cast<double>(spheres)));
  const std::string far = std::to_string(width), beyond = std::to_string(width + 0.1);
  return R"({"tandem": "1.0", "name": "lattice", "end_time": 1.0, "coupling": {"window": 0.001},
    "dem": {"contact": "hertz_mindlin",
      "materials": [{"name": "glass", "density": 2500, "young": 1e8, "poisson": 0.25}],
      "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.4}],
      "particles": [{"name": "all", "material": "glass", "radius": 0.01,
                     "fill": {"type": "lattice", "lattice": "cubic", "min": [0, 0, 0], "spacing": 0.0205,
                              "max": [)" +
         far + ", " + far + ", " + far + R"(], "count": )" + std::to_string(spheres) + R"(}}],
      "walls": [{"name": "floor", "material": "glass",
                 "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
      "domain": {"min": [-0.1, -0.1, -0.1], "max": [)" +
         beyond + ", " + beyond + ", " + beyond + "]}}}";
}

enum class Snapshot { none, save, save_and_restore };

void windows(benchmark::State& state, particles::Backend backend, Snapshot snapshot) {
  std::unique_ptr<ParticleRun> run;
  try {
    run = std::make_unique<ParticleRun>(lattice(state.range(0)), backend);
  } catch (const Error& e) {
    state.SkipWithError(e.what());
    return;
  }
  const auto advance = [&] { run->advance(10, 4e-5); };
  advance();
  run->engine->save();  // the first one allocates the copy
  for (auto _ : state) {
    if (snapshot != Snapshot::none) run->engine->save();
    advance();
    if (snapshot == Snapshot::save_and_restore) run->engine->restore();
  }
  state.counters["bytes_with_copy"] = static_cast<double>(run->engine->memory_bytes());
}

void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(10'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK_CAPTURE(windows, cpu, particles::Backend::cpu, Snapshot::none)->Apply(sizes);
BENCHMARK_CAPTURE(windows, cpu_save, particles::Backend::cpu, Snapshot::save)->Apply(sizes);
BENCHMARK_CAPTURE(windows, cpu_save_restore, particles::Backend::cpu, Snapshot::save_and_restore)
    ->Apply(sizes);
BENCHMARK_CAPTURE(windows, cuda, particles::Backend::cuda, Snapshot::none)->Apply(sizes);
BENCHMARK_CAPTURE(windows, cuda_save, particles::Backend::cuda, Snapshot::save)->Apply(sizes);
BENCHMARK_CAPTURE(windows, cuda_save_restore, particles::Backend::cuda, Snapshot::save_and_restore)
    ->Apply(sizes);

}  // namespace
}  // namespace tandem::test
