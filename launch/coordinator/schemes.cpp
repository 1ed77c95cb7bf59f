#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {
namespace {

// The load of the window before, offered for `window`: a held load. Empty in the first window.
void hold_load(const Window& window, Exchange& exchange) {
  exchange.applied = exchange.load;
  exchange.applied.window = window;
  exchange.held = true;
}

}  // namespace

// Both sides work at once: the bodies under the load of the window before, the particles along the path that
// the bodies would take with the velocity they have now.
void parallel(const Solvers& solvers, const Window& window, Exchange& exchange) {
  solvers.mbd->start_predict(window);
  exchange.path = solvers.mbd->finish_motion();
  hold_load(window, exchange);

  solvers.dem->start_advance(exchange.path);
  solvers.mbd->start_advance(exchange.applied);

  exchange.motion = solvers.mbd->finish_motion();
  exchange.load = solvers.dem->finish_load();
}

// The bodies move under the load of the window before; the particles follow the path that was really taken.
void mbd_first(const Solvers& solvers, const Window& window, Exchange& exchange) {
  hold_load(window, exchange);
  solvers.mbd->start_advance(exchange.applied);
  exchange.motion = solvers.mbd->finish_motion();

  exchange.path = exchange.motion;
  solvers.dem->start_advance(exchange.path);
  exchange.load = solvers.dem->finish_load();
}

// The particles follow the predicted path and return their mean load; the bodies integrate the SAME window
// with it, so that nothing is late and the impulse is booked twice in one window, once on each side.
void dem_first(const Solvers& solvers, const Window& window, Exchange& exchange) {
  solvers.mbd->start_predict(window);
  exchange.path = solvers.mbd->finish_motion();

  solvers.dem->start_advance(exchange.path);
  exchange.load = solvers.dem->finish_load();

  exchange.applied = exchange.load;
  solvers.mbd->start_advance(exchange.applied);
  exchange.motion = solvers.mbd->finish_motion();
}

void mbd_alone(const Solvers& solvers, const Window& window, Exchange& exchange) {
  exchange.applied.window = window;
  solvers.mbd->start_advance(exchange.applied);
  exchange.motion = solvers.mbd->finish_motion();
}

void dem_alone(const Solvers& solvers, const Window& window, Exchange& exchange) {
  exchange.path.window = window;
  solvers.dem->start_advance(exchange.path);
  exchange.load = solvers.dem->finish_load();
}

Step choose_step(scene::Scheme scheme, const Solvers& solvers) {
  if (!solvers.dem) return mbd_alone;
  if (!solvers.mbd) return dem_alone;
  switch (scheme) {
    case scene::Scheme::parallel:
      return parallel;
    case scene::Scheme::mbd_first:
      return mbd_first;
    case scene::Scheme::dem_first:
      return dem_first;
  }
  throw Error(ErrorCode::internal, "unknown coupling scheme");
}

const char* name(scene::Scheme scheme) {
  switch (scheme) {
    case scene::Scheme::parallel:
      return "parallel";
    case scene::Scheme::mbd_first:
      return "mbd_first";
    case scene::Scheme::dem_first:
      return "dem_first";
  }
  return "unknown";
}

}  // namespace tandem::launch
