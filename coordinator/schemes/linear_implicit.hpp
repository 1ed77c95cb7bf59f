// Scheme `linear_implicit`: like dem_first, but the load changes with the deviation of the bodies from the
// predicted path,
//   F = F_dem - (H K + D) (v_end - v_end,predicted),
// with stiffness K and damping D of the contacts that the particle side reports. The displacement is taken as
// H times the change of velocity (implicit Euler), which keeps the scheme stable on any contact; it adds the
// mass H D + H^2 K to the body and so slows vibrations that are faster than a window.
//
// A body in a liquid is heavier by the impulse that it passes to the liquid in a window, I(H). The liquid
// records this impulse in the next window, in which its walls have the new velocity: there it is not applied
// again. So the bodies receive in the end what the liquid recorded.
#pragma once

#include <map>

#include "common/scene/freedoms.hpp"
#include "coordinator/schemes/body_modes.hpp"
#include "coordinator/schemes/path_space.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

class LinearImplicit final : public Scheme {
 public:
  LinearImplicit(const scene::Scene& scene, const Solvers& solvers);
  void advance(const Window& window, Exchange& exchange) override;
  void save_or_restore(Archive& archive) override;

 private:
  using Impulses = std::map<std::uint32_t, Vector6>;  // force, torque; by body [N s] [N m s]
  using Matrices = std::map<std::uint32_t, Matrix6>;

  // Of the exchange, with an entry for each body that responds.
  protocol::TangentSet tangents_of(const Exchange& exchange) const;
  // I(H) of each body that responds.
  Matrices passed_in_window(const Exchange& exchange) const;
  // Changes of the end twists relative to the predicted ones, for the bodies with a tangent (6 x tangents).
  Eigen::VectorXd change(const Exchange& exchange, const protocol::TangentSet& tangents) const;
  // Of all bodies with a tangent at the end [m/s].
  double speed(const Exchange& exchange, const protocol::TangentSet& tangents) const;
  // exchange.load, corrected for these changes, and the impulses by which it is ahead of the liquid.
  protocol::LoadSet corrected(const Exchange& exchange, const protocol::TangentSet& tangents,
                              const Matrices& passed, const Eigen::VectorXd& change, Impulses& ahead) const;

  Solvers solvers_;
  scene::Coupling how_;
  PathSpace space_;
  const scene::Scene& scene_;
  std::vector<scene::Freedom> freedoms_;
  // By which the bodies were ahead of the liquid at the begin of the last window, and at its end. A window
  // that is repeated begins as before.
  Impulses ahead_before_, ahead_;
  std::int64_t last_begin_ = -1;  // [ns]
};

}  // namespace tandem::launch
