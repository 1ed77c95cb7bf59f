// The order of work in one window: which side moves first, and which load and which path each side sees.
// docs/coupling.md has the timelines, the stability limits and the orders.
#pragma once

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"
#include "protocol/remote.hpp"

namespace tandem::launch {

// The solvers of a run; a solver that the scene does not need is null.
struct Solvers {
  protocol::Remote* mbd = nullptr;
  protocol::Remote* dem = nullptr;
};

// All that crossed the border in one window. It is kept from window to window: `load` of the last window is
// what the schemes that hold a load work with. Empty before the first window: no load acts yet.
struct Exchange {
  protocol::MotionSet path;    // that the particles were led along
  protocol::LoadSet load;      // that the particles booked on this path
  protocol::LoadSet applied;   // that the bodies were given
  protocol::MotionSet motion;  // that the bodies made of it
  bool held = false;           // `applied` is the load of the window before
};

// Advances both sides over `window`.
void parallel(const Solvers& solvers, const Window& window, Exchange& exchange);
void mbd_first(const Solvers& solvers, const Window& window, Exchange& exchange);
void dem_first(const Solvers& solvers, const Window& window, Exchange& exchange);
// Without the other side there is nothing to hold, predict or send.
void mbd_alone(const Solvers& solvers, const Window& window, Exchange& exchange);
void dem_alone(const Solvers& solvers, const Window& window, Exchange& exchange);

using Step = void (*)(const Solvers&, const Window&, Exchange&);
// The function that advances one window of this run.
Step choose_step(scene::Scheme scheme, const Solvers& solvers);

const char* name(scene::Scheme scheme);

}  // namespace tandem::launch
