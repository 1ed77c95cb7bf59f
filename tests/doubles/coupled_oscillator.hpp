// The coupled system of OscillatorBody and OscillatorBed.
#pragma once

#include "tests/doubles/coupled_run.hpp"
#include "tests/doubles/oscillator_bed.hpp"
#include "tests/doubles/oscillator_body.hpp"

namespace tandem::test {

class CoupledOscillator {
 public:
  CoupledOscillator(const OscillatorBodyParameters& body, const OscillatorBedParameters& bed,
                    const scene::Coupling& coupling, Channel channel = Channel::inproc);

  void run(double end_time) { run_.run(end_time); }
  void advance(double length) { run_.advance(length); }

  // Spectral radius of a window of this length. A window is a linear map of the states of both sides and of
  // the load that the coupling holds; its columns are the results for unit states.
  double growth(double length);

  OscillatorBody body;
  OscillatorBed bed;
  launch::Coupler& coupler() { return run_.coupler(); }
  const launch::Exchange& exchange() { return run_.exchange(); }

 private:
  bool wall_;  // the bed has no states
  CoupledRun run_;
};

// A scene with a body "mass" that slides along x, and with particles, so that it needs both solvers.
scene::Scene oscillator_scene(const OscillatorBodyParameters& body, const scene::Coupling& coupling);

}  // namespace tandem::test
