// Richardson's extrapolation of generalized-alpha: two independent runs, one with steps of h and one with
// steps of h/2; the state is
//
//   fine + (fine - coarse) / 3      (on the group: fine o exp(x/3), with fine = coarse o exp(x))
//
// in which the global error of second order cancels (Hairer, Norsett, Wanner, Solving ODEs I, II.9). Each run
// keeps the stability of its method, which an extrapolation that continues from its own result would lose. It
// costs three steps for every two of h/2; the constraints hold to the square of the difference between the
// runs.
#pragma once

#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd {

class Richardson final : public Integrator {
 public:
  // Both runs use `method`, which must outlive this object.
  Richardson(GeneralizedAlpha& method, const State& state);

  void start(System& system, State& state, double h) override;
  void jump(System& system, State& state) override;
  void jump(System& system, const State& before, State& state) override;
  void step(System& system, State& state, double h) override;

 private:
  void combine(System& system, State& state);

  GeneralizedAlpha& method_;
  State coarse_, fine_, before_;
  VectorXd difference_;  // (freedoms)
};

}  // namespace tandem::mbd
