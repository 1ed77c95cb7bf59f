// The time that a run has reached, counted separately by each end of a session: the next window must begin
// where the last one ended, on both sides; otherwise the two ends have lost step with each other.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace tandem::protocol {

class Progress {
 public:
  std::uint64_t window() const { return at_.window; }        // index of the next window
  std::uint32_t iteration() const { return at_.iteration; }  // number of restores
  Nanoseconds now() const { return at_.now; }

  // Throws ProtocolError{wrong_window, wrong_time} unless `window` is the next one and has a positive
  // length.
  void expect(const Window& window) const;
  void expect_now(Nanoseconds now) const;
  // Throws unless the answer to an order is about the window of the order.
  void expect_same(const Window& answered, const Window& ordered) const;
  // Records that `window` was integrated.
  void complete(const Window& window);
  // Continues a run of which that number of windows was completed.
  void resume(std::uint64_t windows, Nanoseconds now);
  void save();
  void restore();  // throws ProtocolError{not_allowed} before the first save

  void take_snapshot() { snapshot_ = at_.now; }
  // Whether a frame of `time` is that of the snapshot, which is then used up. Throws
  // ProtocolError{wrong_time} if `time` is neither now nor that of a snapshot.
  bool use_snapshot(Nanoseconds time);

 private:
  struct Mark {
    std::uint64_t window = 0;
    Nanoseconds now;
    std::uint32_t iteration = 0;
  };
  Mark at_, saved_;
  bool has_saved_ = false;
  std::optional<Nanoseconds> snapshot_;
};

}  // namespace tandem::protocol
