// Interface of the methods whose steps an error control can judge, undo and repeat.
#pragma once

#include <optional>
#include <string>

#include "mbd_server/step/integrator.hpp"

namespace tandem::mbd {

// Estimated errors of one step, in System::norm(): [-] and [1/s]; of the first-order states in
// System::state_norm() [-].
struct LocalError {
  double position = 0, velocity = 0, states = 0;
};

struct StepCounters {
  std::uint64_t steps = 0, newton_iterations = 0, factorisations = 0, load_jumps = 0, rejected = 0;
  // Steps accepted although their error of the velocity does not fall with the step.
  std::uint64_t unresolved = 0;
  std::uint64_t evaluations = 0;  // explicit methods: of the accelerations
  std::uint64_t stiff = 0;        // explicit methods: steps as long as stability allows
};

// What an error control needs to know of a method.
struct ControlTraits {
  double order = 0;                      // the local error falls with this power of the step
  double largest_factor = 0;             // between two steps
  double dead_band_low, dead_band_high;  // factors in between are 1: a change of the step costs accuracy
  double shortest_share;                 // steps below this share of the longest step have collapsed
  const char* collapsed = "";            // what the user should write then
};

// Of System::unseen(), in one step: a step that sees less of a force over a coordinate is taken in parts.
inline constexpr double largest_unseen = 0.1;

class ControlledMethod : public Integrator {
 public:
  // Takes a step and returns the estimate of its local error. Where the step is impossible, the state is
  // unchanged, multipliers included, and the result is none.
  virtual std::optional<LocalError> try_step(System& system, State& state, double h) = 0;
  // Restores the state before the last successful try_step().
  virtual void undo(State& state) const = 0;
  // Throws the error of the last try_step() that failed.
  [[noreturn]] virtual void give_up(const System& system, double h) const = 0;
  // The coordinates with the largest errors of the last try_step(), in the user's words.
  virtual std::string largest_position_error(const System& system) const = 0;
  virtual std::string largest_velocity_error(const System& system) const = 0;
  // Of a method that integrates first-order states.
  virtual std::string largest_state_error(const System&) const { return {}; }
  virtual ControlTraits traits() const = 0;

  const StepCounters& counters() const { return counters_; }
  void count_rejected() { ++counters_.rejected; }
  void count_unresolved() { ++counters_.unresolved; }

 protected:
  StepCounters counters_;
};

}  // namespace tandem::mbd
