// A particle participant with a closed-form load: a bed of one mass m on a spring and damper (c2, d2), in
// permanent contact (k, d) with the body, all along x:
//   m y'' + d2 y' + c2 y = -F,   F = k (y - x) + d (y' - x')   on the body.
// Without a mass it is a wall at rest: F = -k x - d x'. The bed receives the path of the body, a cubic in
// time, and integrates its motion by the classical Runge-Kutta method with enough micro steps to make the
// error negligible.
#pragma once

#include "protocol/participant/solver.hpp"

namespace tandem::test {

struct OscillatorBedParameters {
  double mass = 0;                                    // [kg]; 0: a wall
  double contact_stiffness = 1, contact_damping = 0;  // k, d [N/m] [N s/m]
  double stiffness = 0, damping = 0;                  // c2, d2 to the ground [N/m] [N s/m]
  // States its response to a step of the velocity of the body: a liquid of this mass that a damper, the
  // sound, connects with the body. Without stiffness only.
  bool responds = false;
};

class OscillatorBed final : public protocol::LoadSolver {
 public:
  explicit OscillatorBed(const OscillatorBedParameters& parameters) : p_(parameters) {}

  double y = 0, w = 0;  // position and velocity of the bed [m] [m/s]; may be set between windows

  protocol::Configured configure(const protocol::Configuration&) override;
  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override;
  const protocol::TangentSet& linearise() override;
  const protocol::ParticlesFrame& observe() override;
  void save() override { saved_ = {y, w, now_}; }
  void restore() override;
  protocol::Report report() override;
  std::uint64_t capabilities() const override {
    return LoadSolver::capabilities() | protocol::can_linearise |
           (p_.responds ? std::uint64_t{protocol::can_respond} : 0);
  }

  std::uint64_t advances() const { return advances_; }  // windows integrated, including repeated ones

 private:
  struct Saved {
    double y = 0, w = 0;
    Nanoseconds now;
  };
  OscillatorBedParameters p_;
  Nanoseconds now_;
  Saved saved_;
  std::uint64_t advances_ = 0;
  protocol::LoadSet loads_;
  protocol::TangentSet tangents_;
  protocol::ParticlesFrame frame_;
};

}  // namespace tandem::test
