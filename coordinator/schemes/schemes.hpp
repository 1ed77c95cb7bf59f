// The order of work in one window: which side moves first, and which load and which path each side receives.
// docs/coupling.md has the timelines, the stability limits and the orders.
#pragma once

#include <memory>

#include "common/scene/model.hpp"
#include "coordinator/schemes/exchange.hpp"
#include "coordinator/schemes/load_solvers.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Archive;

// Advances both sides over `window`. `how` selects the shapes of load and path.
void parallel(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
void mbd_first(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
void dem_first(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
// With one side only, nothing is held, predicted or sent.
void mbd_alone(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
void dem_alone(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);

// Parts of a window that several schemes use. The predicted path is written to exchange.path.
void predict_path(const Solvers& solvers, scene::PathShape shape, const Window& window, Exchange& exchange);
// The load on the bodies, made from the load that the particles recorded.
protocol::LoadSet shaped(const protocol::LoadSet& load, scene::LoadShape shape);

// Advances both sides over the windows of a run, one after the other.
class Scheme {
 public:
  virtual ~Scheme() = default;
  virtual void advance(const Window& window, Exchange& exchange) = 0;
  // Writes or reads what the scheme remembers from window to window. Most schemes remember nothing.
  virtual void save_or_restore(Archive&) {}
};
std::unique_ptr<Scheme> make_scheme(const scene::Scene& scene, const Solvers& solvers);

const char* name(scene::Scheme scheme);

}  // namespace tandem::launch
