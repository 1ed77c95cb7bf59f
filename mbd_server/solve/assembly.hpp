// The consistent start: positions that close the loops, and rates that keep the loops closed.
#pragma once

#include "common/scene/model.hpp"
#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

struct AssemblyReport {
  int moved_body = none;   // body of the scene that moved furthest; none: nothing moved
  double distance = 0;     // by how much [m]
  double rate_change = 0;  // largest change of a rate, whether the scene gives it or not [rad/s or m/s]
  std::string rate_of;     // name of its coordinate
  // Equations that others imply: idle ones, and those found by redundancy.hpp.
  std::vector<std::string> redundant;
  bool rank_deficient = false;  // there are some found by redundancy.hpp
  double misfit = 0;      // largest residual of a redundant one, relative to the size of its loop, or [rad]
  std::string misfit_of;  // its name
  int degrees_of_freedom = 0;  // of the motion at the start
  // Away from singular positions: less than at the start where loops allow a motion only to first order.
  // Negative or zero for a machine that is wholly driven or overconstrained.
  int lasting_degrees_of_freedom = 0;
};

// Moves the state onto the constraints, in the metric of the masses; rates given by the scene are kept.
// Throws Error{scene} where the loops cannot be closed, where closing them would move a body by more than the
// scene's assembly_tolerance, or where the given rates contradict each other; the error gives the place and
// the amount.
AssemblyReport assemble(const scene::Scene& scene, const Model& model, MachineSystem& system, State& state);

// Throws Error{numerics} where a closure's equation, idle ones included, has grown during the run beyond ten
// times the tolerance of the geometric data: such a loop does not fit together.
void expect_closed(const Model& model, const std::vector<LinkMotion>& links, double tolerance, double time);

// An equation in the user's words: joint "x": displacement along y.
std::string equation_name(const Model& model, int equation);

}  // namespace tandem::mbd
