// Our multibody solver with one fault, for the judge and for the verdict on a run.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "protocol/participant/solver.hpp"

namespace tandem::test {

// A call after which a part of the state is not what it was: the next window has other bits.
enum class Residue { none, restore, second_restore, resume, predict, extrapolate };

// Each function changes what goes into the solver or comes out of it; an empty one leaves it as it is.
struct MotionFault {
  std::string name;
  std::function<void(protocol::Configuration&)> scene{};
  std::function<void(protocol::Configured&)> configured{};
  std::function<void(protocol::LoadSet&)> load{};  // before the solver gets it
  // After the window; `given` is the load that the coordinator sent.
  std::function<void(protocol::MotionSet&, const protocol::LoadSet& given)> motion{};
  std::function<void(protocol::MotionSet&)> predicted{}, extrapolated{};
  std::function<void(protocol::BodiesFrame&)> frame{};
  Residue residue = Residue::none;
  bool predicts_by_advancing = false, delays_load = false, keeps_control_in_restore = false;
};

std::unique_ptr<protocol::MotionSolver> broken(const MotionFault& fault);

}  // namespace tandem::test
