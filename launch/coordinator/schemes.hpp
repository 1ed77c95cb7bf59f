// The order of work in one window: which side moves first, and which load and which path each side receives.
// docs/coupling.md has the timelines, the stability limits and the orders.
#pragma once

#include <memory>

#include "common/scene/model.hpp"
#include "launch/coordinator/load_solvers.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Archive;

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
