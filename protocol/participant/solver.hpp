// The interface that a solver implements to take part in a run. `serve` (serve.hpp) handles the protocol, so
// that a solver gets only these calls, in this order:
//   configure, then any sequence of { predict, advance, save, restore, observe }, then report.
// A call that cannot succeed throws Error; the run then ends on all sides with that error.
#pragma once

#include "protocol/messages.hpp"
#include "protocol/registration.hpp"

namespace tandem::protocol {

class Solver {
 public:
  virtual ~Solver() = default;
  // Which of the calls below this solver answers: capability bits, sent at registration. A coordinator makes
  // no call without its bit, and refuses a scene that needs one.
  virtual std::uint64_t capabilities() const = 0;
  virtual Configured configure(const Configuration& configuration) = 0;
  // can_rollback: one copy of the whole state in memory. restore() may be called more than once per save().
  virtual void save() { throw Error(ErrorCode::protocol, "cannot save its state"); }
  virtual void restore() { throw Error(ErrorCode::protocol, "cannot restore its state"); }
  // can_checkpoint: the same in a file, which is complete or absent; a solver that resumes from it after
  // configure() continues with the same bits as the one that wrote it.
  virtual void checkpoint(const Checkpoint&) { throw Error(ErrorCode::protocol, "cannot write its state"); }
  virtual void resume(const Checkpoint&) { throw Error(ErrorCode::protocol, "cannot continue from a file"); }
  // Final statistics.
  virtual Report report() = 0;
  // can_linearise: stiffness and damping of the contacts of each boundary body at the end of the last window:
  // with particles on the particle side, with other bodies and the ground on the multibody side.
  // can_respond: also the responses to changes of the velocity, and before the first window too.
  virtual const TangentSet& linearise() { throw Error(ErrorCode::protocol, "cannot linearise"); }
};

// Multibody side: loads in, motion out.
class MotionSolver : public Solver {
 public:
  std::uint64_t capabilities() const override { return capabilities_of(Role::mbd); }
  // can_predict: path over the window from the present state, which does not change: joint rates held,
  // prescribed motions exact.
  virtual const MotionSet& predict(const Window&) { throw Error(ErrorCode::protocol, "cannot predict"); }
  // Integrates the window under the mean loads and returns the path taken. The load on bodies that are not
  // in the set is zero.
  virtual const MotionSet& advance(const LoadSet& loads) = 0;
  virtual const BodiesFrame& observe() = 0;
  // can_extrapolate: as predict, with the joint accelerations held as well. `advance` of such a solver
  // integrates loads that are linear in time: mean and first moment.
  virtual const MotionSet& extrapolate(const Window&) {
    throw Error(ErrorCode::protocol, "cannot extrapolate");
  }
  // can_control: the values hold until the next call; they are part of the state that save() copies.
  virtual void control(const ControlSet&) { throw Error(ErrorCode::protocol, "cannot take control inputs"); }
};

// Particle side: motion in, loads out.
class LoadSolver : public Solver {
 public:
  // dem, or sph for a liquid.
  virtual Role role() const { return Role::dem; }
  std::uint64_t capabilities() const override { return capabilities_of(Role::dem); }
  // can_interpolate: follows pose and twist inside the window; can_window_mean: the load is the impulse over
  // the window, divided by its length.
  virtual const LoadSet& advance(const MotionSet& motion) = 0;
  virtual const ParticlesFrame& observe() = 0;
  // can_snapshot: keeps what observe() would return now. read_snapshot() returns it, once, and may be called
  // by another thread while the solver advances.
  virtual void snapshot() { throw Error(ErrorCode::protocol, "cannot keep a snapshot"); }
  virtual const ParticlesFrame& read_snapshot() {
    throw Error(ErrorCode::protocol, "cannot keep a snapshot");
  }
};

}  // namespace tandem::protocol
