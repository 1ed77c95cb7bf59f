// Scheme `linear_implicit`: like dem_first, but the load changes with the deviation of the bodies from the
// predicted path,
//   F = F_dem - (H K + D) (v_end - v_end,predicted),
// with stiffness K and damping D of the contacts that the particle side reports. The displacement is taken as
// H times the change of velocity (implicit Euler), which keeps the scheme stable on any contact; it adds the
// mass H D + H^2 K to the body and so slows vibrations that are faster than a window.
#pragma once

#include "common/scene/freedoms.hpp"
#include "launch/coordinator/path_space.hpp"
#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {

class LinearImplicit final : public Scheme {
 public:
  LinearImplicit(const scene::Scene& scene, const Solvers& solvers);
  void advance(const Window& window, Exchange& exchange) override;

 private:
  // Changes of the end twists relative to the predicted ones, for the bodies with a tangent (6 x tangents).
  Eigen::VectorXd change(const Exchange& exchange, const protocol::TangentSet& tangents) const;
  // exchange.load, corrected for these changes.
  protocol::LoadSet corrected(const Exchange& exchange, const protocol::TangentSet& tangents,
                              const Eigen::VectorXd& change) const;
  // Those of the exchange; the impulse that a body passes to its liquid counts as damping.
  protocol::TangentSet with_responses(const Exchange& exchange) const;

  Solvers solvers_;
  scene::Coupling how_;
  PathSpace space_;
  const scene::Scene& scene_;
  std::vector<scene::Freedom> freedoms_;
};

}  // namespace tandem::launch
