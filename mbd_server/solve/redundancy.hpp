// Finds the equations of loops that other equations imply in every configuration: the second hinge of a door,
// the third crank of a parallelogram. Lengths and axes of a file have a few digits only, so that no two
// equations are exactly dependent, and two independent ones may look dependent at the start (at a dead
// point). So an equation counts as redundant if the others imply it over a finite motion, within the
// tolerance of the data:
//
// 1. Equations that hardly differ from others at the start are candidates.
// 2. The machine moves as the other equations allow, in small steps that close them, by 0.4 rad or 0.4
// lengths.
// 3. A candidate that opens by at most `tolerance` of the path of its terms is redundant. A candidate that
// opens by 3 %, or by an increasing share as it leaves a singular position, is independent, and joins the
// others when the remaining candidates are tested. A candidate in between is independent if its loop can move
// with it. Otherwise the data contradict each other: the loop is locked if the candidate is kept closed, and
// opens if it is not.
#pragma once

#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

struct Redundancy {
  // The redundant ones, ascending; which of a closure's equations these are is a choice.
  std::vector<int> equations;
  std::vector<int> rows;  // how many (closures)
  struct Contradiction {
    int equation = none;  // none: there is no contradiction
    double opening = 0;   // at the end of the motion [m or rad]
    double share = 0;     // of the path of its terms
  } contradiction;        // the largest
};

// `tolerance`: of lengths relative to the loop, and of directions [rad].
Redundancy find_redundancy(const Model& model, MachineSystem& system, const State& start, double tolerance);

}  // namespace tandem::mbd
