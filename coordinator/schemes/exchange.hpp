// What the solvers exchange in one window.
#pragma once

#include <span>
#include <vector>

#include "protocol/messages.hpp"

namespace tandem::launch {

// All data exchanged at the interface of the solvers in one window. It is kept from window to window: schemes
// that hold a load use the `load` of the last window. Empty before the first window: no load acts yet.
struct Exchange {
  protocol::MotionSet path;  // prescribed to the particles
  protocol::LoadSet load;    // of all particles along this path
  // Where several solvers have particles, the loads of each, in the order of Solvers::loads; else empty.
  std::vector<protocol::LoadSet> parts;
  protocol::LoadSet applied;      // that acted on the bodies
  protocol::MotionSet motion;     // of the bodies under that load
  protocol::TangentSet tangents;  // of the contacts at the window's end, where the scheme needs them
  bool held = false;              // `applied` is the load of the previous window
  int iterations = 1;             // passes of the particles through the window

  // The loads of each load solver, in their order: `load` where there is one.
  std::span<const protocol::LoadSet> loads() const {
    return parts.empty() ? std::span(&load, 1) : std::span(parts);
  }
};

}  // namespace tandem::launch
