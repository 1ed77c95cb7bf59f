// A channel that has failed stays failed: a peer that comes back late, or the rest of a broken frame, stays
// out.
#pragma once

#include <optional>

#include "common/error.hpp"

namespace tandem::protocol {

class FailureLatch {
 public:
  // Runs f, unless an earlier call failed: then that Error again.
  template <class F>
  auto operator()(F&& f) {
    if (failure_) throw Error(*failure_);
    try {
      return f();
    } catch (const Error& e) {
      failure_ = e;
      throw;
    }
  }

 private:
  std::optional<Error> failure_;
};

}  // namespace tandem::protocol
