#include "coordinator/schemes/schemes.hpp"

#include <memory>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

// The load of the previous window, relabelled for `window`: a held load. Empty in the first window.
void hold_load(const scene::Coupling& how, const Window& window, Exchange& exchange) {
  exchange.applied = shaped(exchange.load, how.load);
  exchange.applied.window = window;
  exchange.held = true;
}

}  // namespace

void predict_path(const Solvers& solvers, scene::PathShape shape, const Window& window, Exchange& exchange) {
  if (shape == scene::PathShape::linear)
    solvers.mbd->start_predict(window);
  else
    solvers.mbd->start_extrapolate(window);
  exchange.path = solvers.mbd->finish_motion();
}

protocol::LoadSet shaped(const protocol::LoadSet& load, scene::LoadShape shape) {
  protocol::LoadSet result = load;
  if (shape == scene::LoadShape::linear) return result;
  for (protocol::BodyLoad& body : result.bodies) {
    body.first_moment = {};
    if (shape == scene::LoadShape::end) body.mean = body.end;
  }
  return result;
}

// Both sides work concurrently: the bodies under the load of the previous window, the particles along the
// path that the bodies would take with their present velocity.
void parallel(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange) {
  predict_path(solvers, how.path, window, exchange);
  hold_load(how, window, exchange);

  start_loads(solvers, exchange.path);
  solvers.mbd->start_advance(exchange.applied);

  exchange.motion = solvers.mbd->finish_motion();
  finish_loads(solvers, exchange);
}

// The bodies move under the load of the previous window; the particles follow the path that the bodies took.
void mbd_first(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange) {
  hold_load(how, window, exchange);
  solvers.mbd->start_advance(exchange.applied);
  exchange.motion = solvers.mbd->finish_motion();

  exchange.path = exchange.motion;
  start_loads(solvers, exchange.path);
  finish_loads(solvers, exchange);
}

// The particles follow the predicted path and return their mean load; the bodies integrate the SAME window
// with it, so that the load is not delayed and both sides record the impulse in the same window.
void dem_first(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange) {
  predict_path(solvers, how.path, window, exchange);

  start_loads(solvers, exchange.path);
  finish_loads(solvers, exchange);

  exchange.applied = shaped(exchange.load, how.load);
  solvers.mbd->start_advance(exchange.applied);
  exchange.motion = solvers.mbd->finish_motion();
}

void mbd_alone(const Solvers& solvers, const scene::Coupling&, const Window& window, Exchange& exchange) {
  exchange.applied.window = window;
  solvers.mbd->start_advance(exchange.applied);
  exchange.motion = solvers.mbd->finish_motion();
}

void dem_alone(const Solvers& solvers, const scene::Coupling&, const Window& window, Exchange& exchange) {
  exchange.path.window = window;
  start_loads(solvers, exchange.path);
  finish_loads(solvers, exchange);
}

const char* name(scene::Scheme scheme) {
  switch (scheme) {
    case scene::Scheme::parallel:
      return "parallel";
    case scene::Scheme::mbd_first:
      return "mbd_first";
    case scene::Scheme::dem_first:
      return "dem_first";
    case scene::Scheme::linear_implicit:
      return "linear_implicit";
    case scene::Scheme::implicit:
      return "implicit";
  }
  return "unknown";
}

}  // namespace tandem::launch
