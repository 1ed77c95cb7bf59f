// Scheme `implicit`: repeats dem_first from the same state until the bodies end where the particles'
// prescribed path ends. Both sides return to the window's begin for each iteration.
//
// With the mean of the load, the path prescribed to the particles has constant velocity: the predicted
// velocity and a constant correction. Load and path then correspond to each other, F and (x1 - x0) / H, as in
// the midpoint rule. The window is stable on any contact, and the bodies receive the impulse that the
// particles give. A load that is linear in time is combined with the cubic path through the ends of the
// motion: fourth order, for a window that resolves its contacts.
#pragma once

#include <memory>

#include "common/error.hpp"
#include "common/scene/freedoms.hpp"
#include "coordinator/schemes/acceleration.hpp"
#include "coordinator/schemes/path_space.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

// The iteration of a window did not converge; both sides are at some time inside the window, and can be
// restored.
class NotConverged : public Error {
 public:
  using Error::Error;
};

class Implicit final : public Scheme {
 public:
  Implicit(const scene::Scene& scene, const Solvers& solvers);
  void advance(const Window& window, Exchange& exchange) override;
  void save_or_restore(Archive& archive) override { accelerator_->save_or_restore(archive); }

 private:
  // (1 - g')^-1 of the step from a path to the one that its load causes, by the response of the liquid. Empty
  // where no liquid responds.
  Eigen::MatrixXd expected_step(const protocol::MotionSet& predicted,
                                const std::vector<protocol::BodyResponse>& responses) const;
  [[noreturn]] void give_up(const Window& window, const Eigen::VectorXd& residual, double allowed,
                            const Exchange& exchange) const;

  Solvers solvers_;
  scene::Coupling how_;
  scene::Iteration iteration_;
  PathSpace space_;
  std::vector<std::string> names_;  // of the bodies
  const scene::Scene& scene_;
  std::vector<scene::Freedom> freedoms_;
  std::unique_ptr<Accelerator> accelerator_;
};

}  // namespace tandem::launch
