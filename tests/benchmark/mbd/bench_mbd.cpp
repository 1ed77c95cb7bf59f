// Processor time of a step over the size of the machine: chains of links, and ladders of closed loops. Writes
// CSV.
#include <algorithm>
#include <cstdio>
#include <vector>

#include "common/cpu_time.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

// The median of several. The least would favour the short cases: many repetitions meet the moments in which a
// processor with an idle neighbour runs faster.
template <class Work>
double typical(int repetitions, const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < repetitions; ++i) {
    const double begin = cpu_seconds(CpuClock::thread);
    work();
    times.push_back(cpu_seconds(CpuClock::thread) - begin);
  }
  std::nth_element(times.begin(), times.begin() + repetitions / 2, times.end());
  return times[static_cast<std::size_t>(repetitions / 2)];
}

// Per step and part, and per part of the three things that steps are made of.
void measure(const char* topology, int parts, const scene::Scene& scene) {
  machines::Run run(scene, 1e-4, 0.9, {1e-10, 20});
  run.advance(2);
  const State begin = run.state;
  const int repetitions = std::max(20, 40000 / parts);
  // Always the same few steps, so that all sizes need the same iterations.
  constexpr int steps = 4;
  const StepCounters before = run.integrator.counters();
  const double step = typical(repetitions, [&] {
    run.state = begin;
    run.advance(steps);
  });
  const StepCounters& c = run.integrator.counters();
  const auto iterations = static_cast<double>(c.newton_iterations - before.newton_iterations);

  VectorXd x = VectorXd::Zero(run.model.freedoms), dx = x, r = run.system.residual(run.state);
  VectorXd phi = VectorXd::Zero(run.model.equations), dlambda = phi;
  const double residual = typical(repetitions, [&] { run.system.residual(run.state); });
  const double factorise = typical(repetitions, [&] { run.system.factorise({1e8, 1e4, 1}, x); });
  const double solve = typical(repetitions, [&] { run.system.solve(r, phi, dx, dlambda); });
  const double scale = 1e6 / parts;
  std::printf("%s,%d,%d,%.4f,%.4f,%.4f,%.4f,%.2f\n", topology, parts, run.model.freedoms,
              scale * step / steps, scale * residual, scale * factorise, scale * solve,
              iterations / (repetitions * steps));
  std::fflush(stdout);
}

}  // namespace
}  // namespace tandem::mbd

int main() {
  using namespace tandem::mbd;
  std::printf("topology,parts,freedoms,us_step,us_residual,us_factorise,us_solve,iterations_per_step\n");
  for (const int links : {1, 4, 16, 32, 64, 128, 256, 512, 1000, 2000, 5000, 10000})
    measure("chain", links, machines::chain(links));
  for (const int windows : {2, 5, 10, 20, 40, 100, 200, 500, 1000})
    measure("ladder", windows, machines::ladder(windows));
}
