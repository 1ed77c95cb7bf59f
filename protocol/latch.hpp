// A channel that has failed remains failed: a peer that returns late and the rest of a broken frame are
// ignored.
#pragma once

#include <optional>

#include "common/error.hpp"

namespace tandem::protocol {

class FailureLatch {
 public:
  // Runs f, unless an earlier call failed: then throws the same Error again.
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
