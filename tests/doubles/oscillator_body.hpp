// A multibody participant with a closed-form motion: one mass on a spring and damper, which moves along x,
//   m x'' + d x' + c x = F(t).
// It integrates a load that is linear in time by the classical Runge-Kutta method, with enough steps to make
// the error negligible; without the spring the result is exact.
#pragma once

#include "protocol/participant/solver.hpp"

namespace tandem::test {

struct OscillatorBodyParameters {
  double mass = 1;                    // [kg]
  double stiffness = 0, damping = 0;  // to the ground [N/m] [N s/m]
};

class OscillatorBody final : public protocol::MotionSolver {
 public:
  explicit OscillatorBody(const OscillatorBodyParameters& parameters) : p_(parameters) {}

  double x = 0, v = 0;  // [m] [m/s]; may be set between windows
  double force = 0;     // load at the end of the last window [N]; may be set between windows

  protocol::Configured configure(const protocol::Configuration&) override;
  const protocol::MotionSet& predict(const Window& window) override;
  const protocol::MotionSet& extrapolate(const Window& window) override;
  const protocol::MotionSet& advance(const protocol::LoadSet& loads) override;
  const protocol::BodiesFrame& observe() override;
  void save() override { saved_ = {x, v, force, now_}; }
  void restore() override;
  protocol::Report report() override;
  std::uint64_t capabilities() const override {
    return MotionSolver::capabilities() | protocol::can_extrapolate;
  }

  std::uint64_t advances() const { return advances_; }  // windows integrated, including repeated ones

 private:
  struct Saved {
    double x = 0, v = 0, force = 0;
    Nanoseconds now;
  };
  double acceleration(double position, double velocity, double load) const {
    return (load - p_.stiffness * position - p_.damping * velocity) / p_.mass;
  }
  const protocol::MotionSet& path(const Window& window, double a);

  OscillatorBodyParameters p_;
  Nanoseconds now_;
  Saved saved_;
  std::uint64_t advances_ = 0;
  protocol::MotionSet motion_;
  protocol::BodiesFrame frame_;
};

}  // namespace tandem::test
