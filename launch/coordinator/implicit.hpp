// Scheme `implicit`: dem_first repeated from the same state until the bodies end where the particles were
// led. Both sides go back to the window's begin for each iteration.
//
// With the mean of the load the particles are led at constant velocity, the predicted one and a constant
// correction: load and path then belong together, F and (x1 - x0) / H, as in the midpoint rule. The window is
// stable on any contact, and what the particles give is what the bodies receive. A load that is linear in
// time goes with the cubic that the ends of the motion give: of fourth order, for a window that resolves its
// contacts.
#pragma once

#include <memory>

#include "common/error.hpp"
#include "launch/coordinator/acceleration.hpp"
#include "launch/coordinator/path_space.hpp"
#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {

// The iteration of a window did not converge; both sides are somewhere inside it, and can be restored.
class NotConverged : public Error {
 public:
  using Error::Error;
};

class Implicit final : public Scheme {
 public:
  Implicit(const scene::Scene& scene, const Solvers& solvers);
  void advance(const Window& window, Exchange& exchange) override;
  void keep(Archive& archive) override { accelerator_->keep(archive); }

 private:
  [[noreturn]] void give_up(const Window& window, const Eigen::VectorXd& residual, double allowed,
                            const Exchange& exchange) const;

  Solvers solvers_;
  scene::Coupling how_;
  scene::Iteration iteration_;
  PathSpace space_;
  std::vector<std::string> names_;  // of the bodies
  std::unique_ptr<Accelerator> accelerator_;
};

}  // namespace tandem::launch
