// Joints with stiction: dry friction that holds a joint at rest. A coordinate either sticks, and is locked,
// or slides, and has a constant force. So
//
// - a step in which the rate of a sliding coordinate reverses is repeated so that it ends where the rate is
//   zero; there the coordinate sticks, if less than the breakaway force holds it, or slides the other way;
// - a step in which the force that holds a coordinate passes the breakaway force is repeated so that it ends
//   there, and the coordinate slides from then on.
//
// A coordinate that sticks keeps its value to the bit.
#pragma once

#include <functional>

#include "mbd_server/model/model.hpp"
#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd {

struct StictionCounters {
  std::uint64_t stuck = 0, broken_away = 0;  // coordinates that came to rest; that began to slide
};

class Stiction {
 public:
  // Takes one step of at most the given length of the state, and returns its length [s].
  using Stride = std::function<double(double)>;

  Stiction(const Model& model, GeneralizedAlpha& method, System& system, const State& state);

  // Sets which coordinates stick and which slide, from their rates and the forces on them. Call before the
  // integrator's start.
  void prepare(State& state);
  // Takes one step of at most h that contains no change between sticking and sliding. Returns its length,
  // which may be 0 [s].
  double step(State& state, double h, const Stride& stride);

  const StictionCounters& counters() const { return counters_; }
  // Takes back what a step has counted.
  void back(const StictionCounters& before) { counters_ = before; }

 private:
  const JointForce& force(int i) const {
    return model_.joint_forces[static_cast<std::size_t>(model_.stictions[i])];
  }
  int freedom(int i) const { return model_.links[force(i).link].u; }
  double excess(const State& state, const VectorXd& residual, int i) const;
  void hold(State& state, int i) const;
  bool settle(State& state, double h);
  bool is_reversed(const State& state, int i) const;
  double passed(const State& state, double h);
  bool passes(const State& state);

  const Model& model_;
  GeneralizedAlpha& method_;
  System& system_;
  State before_;
  StictionCounters counters_;
  std::vector<double> held_before_;  // excess() at the begin of the step (stictions)
};

}  // namespace tandem::mbd
