// The two doubles served in threads, and the coordinator's coupler between them, over real channels.
#pragma once

#include <memory>
#include <thread>

#include "launch/coordinator/coupler.hpp"
#include "tests/doubles/oscillator_bed.hpp"
#include "tests/doubles/oscillator_body.hpp"

namespace tandem::test {

enum class Channel { inproc, shm };

class CoupledOscillator {
 public:
  CoupledOscillator(const OscillatorBodyParameters& body, const OscillatorBedParameters& bed,
                    const scene::Coupling& coupling, Channel channel = Channel::inproc);
  ~CoupledOscillator();
  CoupledOscillator(const CoupledOscillator&) = delete;
  CoupledOscillator& operator=(const CoupledOscillator&) = delete;

  // Windows up to this time [s].
  void run(double end_time);
  // One window of this length [s], or of the scene's where that is shorter.
  void advance(double length);

  // Spectral radius of a window of this length, which is a linear map of the states of both sides and of the
  // load that is held: its columns are what a window makes of the unit states.
  double growth(double length);

  // Both servers wait between windows: then the solvers may be read and set.
  OscillatorBody body;
  OscillatorBed bed;
  launch::Coupler& coupler() { return *coupler_; }
  const launch::Exchange& exchange() { return coupler_->exchange(); }

 private:
  bool wall_;  // the bed has no states
  scene::Scene scene_;
  std::thread body_thread_, bed_thread_;
  std::unique_ptr<protocol::Remote> to_body_, to_bed_;
  std::unique_ptr<launch::Coupler> coupler_;
};

// A body called "mass" that slides along x, and particles, so that both solvers are needed.
scene::Scene oscillator_scene(const OscillatorBodyParameters& body, const scene::Coupling& coupling);

}  // namespace tandem::test
