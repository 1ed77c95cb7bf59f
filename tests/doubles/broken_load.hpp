// Our particle solver with one fault, for the judge and for the verdict on a run.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "protocol/participant/solver.hpp"

namespace tandem::test {

// Each function changes what goes into the solver or comes out of it; an empty one leaves it as it is.
struct LoadFault {
  std::string name;
  std::function<void(std::string&)> scene{};         // its JSON; may throw Error{scene}
  std::function<void(protocol::MotionSet&)> path{};  // before the solver gets it
  // After the window; `given` is the path that the coordinator sent.
  std::function<void(protocol::LoadSet&, const protocol::MotionSet& given)> load{};
  std::function<void(protocol::ParticlesFrame&)> frame{}, snapshot{};
  std::function<void(protocol::TangentSet&)> tangents{};
  bool delays_load = false;       // gives the load of the last window
  bool restores_roughly = false;  // the first window after restore has other bits
  bool resumes_roughly = false;
};

std::unique_ptr<protocol::LoadSolver> broken(const LoadFault& fault);

}  // namespace tandem::test
