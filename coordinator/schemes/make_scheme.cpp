#include "common/error.hpp"
#include "coordinator/schemes/implicit.hpp"
#include "coordinator/schemes/linear_implicit.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {
namespace {

// A scheme that is one function.
class Memoryless final : public Scheme {
 public:
  using Advance = void (*)(const Solvers&, const scene::Coupling&, const Window&, Exchange&);
  Memoryless(const Solvers& solvers, const scene::Coupling& how, Advance function)
      : solvers_(solvers), how_(how), advance_(function) {}
  void advance(const Window& window, Exchange& exchange) override {
    advance_(solvers_, how_, window, exchange);
  }

 private:
  Solvers solvers_;
  scene::Coupling how_;
  Advance advance_;
};

}  // namespace

std::unique_ptr<Scheme> make_scheme(const scene::Scene& scene, const Solvers& solvers) {
  const auto without_memory = [&](auto advance) {
    return std::make_unique<Memoryless>(solvers, scene.coupling, advance);
  };
  if (solvers.loads.empty()) return without_memory(mbd_alone);
  if (!solvers.mbd) return without_memory(dem_alone);
  switch (scene.coupling.scheme) {
    case scene::Scheme::parallel:
      return without_memory(parallel);
    case scene::Scheme::mbd_first:
      return without_memory(mbd_first);
    case scene::Scheme::dem_first:
      return without_memory(dem_first);
    case scene::Scheme::linear_implicit:
      return std::make_unique<LinearImplicit>(scene, solvers);
    case scene::Scheme::implicit:
      return std::make_unique<Implicit>(scene, solvers);
  }
  throw Error(ErrorCode::internal, "unknown coupling scheme");
}

}  // namespace tandem::launch
