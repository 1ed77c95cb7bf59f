// The order of work in one window: which side moves first, and which load and which path each side sees.
// docs/coupling.md has the timelines, the stability limits and the orders.
#pragma once

#include <memory>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"
#include "protocol/remote.hpp"

namespace tandem::launch {

class Archive;

// The solvers of a run; a solver that the scene does not need is null.
struct Solvers {
  protocol::Remote* mbd = nullptr;
  protocol::Remote* dem = nullptr;
};

// All that crossed the border in one window. It is kept from window to window: `load` of the last window is
// what the schemes that hold a load work with. Empty before the first window: no load acts yet.
struct Exchange {
  protocol::MotionSet path;       // that the particles were led along
  protocol::LoadSet load;         // that the particles booked on this path
  protocol::LoadSet applied;      // that the bodies were given
  protocol::MotionSet motion;     // that the bodies made of it
  protocol::TangentSet tangents;  // of the contacts at the window's end, where they were asked for
  bool held = false;              // `applied` is the load of the window before
  int iterations = 1;             // how often the particles went through the window
};

// Advances both sides over `window`. `how` says what load and path are made of.
void parallel(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
void mbd_first(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
void dem_first(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
// Without the other side there is nothing to hold, predict or send.
void mbd_alone(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);
void dem_alone(const Solvers& solvers, const scene::Coupling& how, const Window& window, Exchange& exchange);

// Parts of a window that schemes share. The predicted path goes to exchange.path.
void predict_path(const Solvers& solvers, scene::PathShape shape, const Window& window, Exchange& exchange);
// What the bodies get of a load that the particles booked.
protocol::LoadSet shaped(const protocol::LoadSet& load, scene::LoadShape shape);

// Advances both sides over the windows of a run, one after the other.
class Scheme {
 public:
  virtual ~Scheme() = default;
  virtual void advance(const Window& window, Exchange& exchange) = 0;
  // Writes or reads what the scheme remembers from window to window. Most schemes remember nothing.
  virtual void keep(Archive&) {}
};
std::unique_ptr<Scheme> make_scheme(const scene::Scene& scene, const Solvers& solvers);
// Capability bits that the solvers of a run need.
std::uint64_t needed_of_mbd(const scene::Scene& scene);
std::uint64_t needed_of_dem(const scene::Scene& scene);

const char* name(scene::Scheme scheme);

}  // namespace tandem::launch
