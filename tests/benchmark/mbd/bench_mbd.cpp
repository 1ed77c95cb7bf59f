// Processor time of a step over the size of the machine: chains of links, and ladders of closed loops. Writes
// CSV.
#include <algorithm>
#include <cstdio>

#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

void measure(const char* topology, int parts, const scene::Scene& scene) {
  machines::Run run(scene, 1e-4, 0.9, {1e-10, 20});
  // Always the same few steps, so that all sizes need the same iterations.
  constexpr int steps = 4;
  run.advance(2);
  const State begin = run.state;
  // The least of several: whatever else the machine does only adds.
  double best = 1e9;
  const StepCounters before = run.integrator.counters();
  const int repetitions = std::max(20, 40000 / parts);
  for (int i = 0; i < repetitions; ++i) {
    run.state = begin;
    best = std::min(best, run.advance_timed(steps) / steps);
  }
  const StepCounters& c = run.integrator.counters();
  const double taken = repetitions * steps;
  std::printf("%s,%d,%d,%.3f,%.4f,%.2f,%.2f\n", topology, parts, run.model.freedoms, 1e6 * best,
              1e6 * best / parts, static_cast<double>(c.newton_iterations - before.newton_iterations) / taken,
              static_cast<double>(c.factorisations - before.factorisations) / taken);
  std::fflush(stdout);
}

}  // namespace
}  // namespace tandem::mbd

int main() {
  using namespace tandem::mbd;
  std::printf(
      "topology,parts,freedoms,us_per_step,us_per_step_and_part,iterations_per_step,factorisations_per_"
      "step\n");
  for (const int links : {16, 32, 64, 128, 256, 512, 1000, 2000, 5000, 10000})
    measure("chain", links, machines::chain(links));
  for (const int windows : {2, 5, 10, 20, 40, 100, 200, 500, 1000})
    measure("ladder", windows, machines::ladder(windows));
}
