// Which equations of the loops say what others say already, whatever the configuration: the second hinge of a
// door, the third crank of a parallelogram. Lengths and axes of a file have a few digits only, so that no two
// equations are exactly dependent, and two that are independent may look dependent at the start (at a dead
// point). So an equation counts as redundant if the others imply it over a finite motion, within the
// tolerance of the data:
//
//   1. Equations that hardly differ from others at the start are candidates.
//   2. The machine moves along what the other equations allow, in small steps that close them, by 0.4 rad or
//   0.4 lengths.
//   3. A candidate that opens by at most `tolerance` of the way which its terms went is redundant. One that
//   opens by 3 % of
//      it, or by more and more as it leaves a singular position, is independent, and joins the others for the
//      candidates that are left. One in between is independent if its loop can move with it, and else a
//      contradiction of the data: closed it locks the loop, open it tears it.
#pragma once

#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

struct Redundancy {
  std::vector<int> equations;  // that are redundant, ascending; which of a closure's is a matter of choice
  std::vector<int> rows;       // how many (closures)
  struct Contradiction {
    int equation = none;  // none: there is no contradiction
    double opening = 0;   // at the end of the motion [m or rad]
    double share = 0;     // of the way that its terms went
  } contradiction;        // the largest
};

// `tolerance`: of lengths relative to the loop, and of directions [rad].
Redundancy find_redundancy(const Model& model, MachineSystem& system, const State& start, double tolerance);

}  // namespace tandem::mbd
