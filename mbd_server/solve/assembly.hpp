// The consistent start: positions that close the loops, and rates that keep them closed.
#pragma once

#include "common/scene/model.hpp"
#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

struct AssemblyReport {
  int moved_body = none;   // of the scene, the one that moved furthest; none: nothing moved
  double distance = 0;     // by how much [m]
  double rate_change = 0;  // largest change of a rate that the scene gives or leaves at zero [rad/s or m/s]
  std::string rate_of;     // its coordinate
  std::vector<std::string> redundant;  // equations that others imply: idle ones, and those of redundancy.hpp
  bool rank_deficient = false;         // some of redundancy.hpp
  double misfit = 0;      // largest opening of a redundant one, relative to the size of its loop, or [rad]
  std::string misfit_of;  // its name
  int degrees_of_freedom = 0;  // of the motion at the start
  // Off singular positions: less than at the start where loops allow a motion at its beginning only. Of a
  // machine that is driven as a whole, or has a joint too many, it is negative or zero.
  int lasting_degrees_of_freedom = 0;
};

// Moves the state onto the constraints, in the metric of the masses; rates that the scene gives are kept.
// Throws Error{scene} where the loops cannot be closed, where that would move a body by more than
// the scene's assembly_tolerance, or where the given rates contradict each other; the error says which and
// how far.
AssemblyReport assemble(const scene::Scene& scene, const Model& model, MachineSystem& system, State& state);

// Throws Error{numerics} where an equation of a closure, idle ones included, has opened in the course of the
// run by more than ten times the tolerance of the geometric data: its loop does not fit together.
void expect_closed(const Model& model, const std::vector<LinkMotion>& links, double tolerance, double time);

// An equation in the user's words: joint "x": displacement along y.
std::string equation_name(const Model& model, int equation);

}  // namespace tandem::mbd
