// Processor time and error of whole runs of two trees, for against_peers.py, and of the scenes in
// launch/scenes/mbd, by their names:
//
//   bench_trees chain LINKS END METHOD ACCURACY REPETITIONS
//   bench_trees pendulum END METHOD ACCURACY REPETITIONS
//   bench_trees SCENE END METHOD ACCURACY REPETITIONS
//
// METHOD is dormand_prince, whose ACCURACY is the error tolerance, or generalized_alpha or extrapolate, whose
// ACCURACY is the number of steps. Prints a line for each repetition with the processor time of all windows
// in seconds, without start-up; a line with the number of steps, of evaluations and the largest error of the
// energy in J; and a line with the joint coordinates at the end.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "common/cpu_time.hpp"
#include "tests/verification/mbd/whole_run.hpp"

int main(int count, char** arguments) {
  using namespace tandem;
  const bool chain = count == 7 && arguments[1] == std::string("chain");
  if (!chain && count != 6) return 2;
  char** argument = arguments + (chain ? 3 : 2);
  const std::string name = arguments[1];
  scene::Scene scene = chain                ? mbd::machines::chain(std::atoi(arguments[2]))
                       : name == "pendulum" ? mbd::machines::pendulum()
                                            : mbd::machines::shipped(name);
  scene.end_time = scene.coupling.window = std::atof(argument[0]);
  scene::Integrator& integrator = scene.mbd->integrator;
  const double accuracy = std::atof(argument[2]);
  if (argument[1] == std::string("dormand_prince")) {
    integrator.method = scene::IntegrationMethod::dormand_prince;
    integrator.error_tolerance = accuracy;
  } else {
    integrator.rho_inf = 0.9;
    integrator.step = scene.end_time / accuracy;
    integrator.extrapolate = argument[1] == std::string("extrapolate");
  }
  const int repetitions = std::atoi(argument[3]);
  for (int r = 0; r < repetitions; ++r) {
    mbd::MbdSolver solver;
    solver.configure(scene);
    protocol::LoadSet loads;
    loads.window = {0, {0}, to_nanoseconds(scene.end_time)};
    const double begin = cpu_seconds(CpuClock::thread);
    solver.advance(loads);
    std::printf("%.9g\n", cpu_seconds(CpuClock::thread) - begin);
    if (r + 1 < repetitions) continue;
    const auto facts = nlohmann::json::parse(solver.report().facts);
    std::printf("%lld %lld %.6g\n", facts["mbd_steps"].get<long long>(),
                facts["mbd_evaluations"].get<long long>(),
                std::abs(facts["mbd_largest_energy_balance_J"].get<double>()));
    for (const double q : solver.state().q) std::printf("%.17g ", q);
    std::printf("\n");
  }
}
