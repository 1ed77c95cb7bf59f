// The interface that a solver implements to take part in a run. `serve` (serve.hpp) handles the protocol, so
// that a solver gets only these calls, in this order:
//   configure, then any sequence of { predict, advance, save, restore, observe }, then report.
// A call that cannot succeed throws Error; the run then ends on all sides with that error.
#pragma once

#include "protocol/messages.hpp"

namespace tandem::protocol {

class Solver {
 public:
  virtual ~Solver() = default;
  virtual Configured configure(const Configuration& configuration) = 0;
  // One copy of the whole state in memory. restore() may be called more than once per save().
  virtual void save() = 0;
  virtual void restore() = 0;
  // can_checkpoint: the same in a file, which is complete or absent; a solver that resumes from it after
  // configure() continues with the same bits as the one that wrote it.
  virtual void checkpoint(const Checkpoint&) { throw Error(ErrorCode::protocol, "cannot write its state"); }
  virtual void resume(const Checkpoint&) { throw Error(ErrorCode::protocol, "cannot continue from a file"); }
  // Final statistics.
  virtual Report report() = 0;
  // Capability bits in addition to those of every solver of its side: they state which of the calls below
  // it overrides.
  virtual std::uint64_t extras() const { return 0; }
};

// Multibody side: loads in, motion out.
class MotionSolver : public Solver {
 public:
  // Path over the window from the present state, which does not change: joint rates held, prescribed
  // motions exact.
  virtual const MotionSet& predict(const Window& window) = 0;
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
  virtual const LoadSet& advance(const MotionSet& motion) = 0;
  virtual const ParticlesFrame& observe() = 0;
  // can_linearise: stiffness and damping of the contacts of each boundary body at the end of the last
  // window.
  virtual const TangentSet& linearise() { throw Error(ErrorCode::protocol, "cannot linearise"); }
};

}  // namespace tandem::protocol
