// Where a run stands in time, as each end of a session keeps it for itself: the next window must begin where
// the last one ended, on both sides, or one of them is not integrating what the other believes.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace tandem::protocol {

class Progress {
 public:
  std::uint64_t window() const { return at_.window; }        // index of the window to come
  std::uint32_t iteration() const { return at_.iteration; }  // how often it was restored
  Nanoseconds now() const { return at_.now; }

  // Throws ProtocolError{wrong_window, wrong_time} unless `window` is the one to come, and has a length.
  void expect(const Window& window) const;
  void expect_now(Nanoseconds now) const;
  // The answer to an order must be about the window of the order.
  void expect_same(const Window& answered, const Window& ordered) const;
  // `window` was integrated.
  void complete(const Window& window);
  // The run goes on where another one stopped, which had done so many windows.
  void resume(std::uint64_t windows, Nanoseconds now);
  void save();
  void restore();  // throws ProtocolError{not_allowed} before the first save

 private:
  struct Mark {
    std::uint64_t window = 0;
    Nanoseconds now;
    std::uint32_t iteration = 0;
  };
  Mark at_, saved_;
  bool has_saved_ = false;
};

}  // namespace tandem::protocol
