#include "protocol/progress.hpp"

#include <string>

#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

std::string text(Nanoseconds t) {
  return std::to_string(t.count) + " ns";
}

}  // namespace

void Progress::expect(const Window& window) const {
  if (window.index != at_.window)
    throw ProtocolError(Violation::wrong_window, "window.index is " + std::to_string(window.index) +
                                                     ", expected " + std::to_string(at_.window));
  if (window.begin != at_.now)
    throw ProtocolError(Violation::wrong_time, "window.begin is " + text(window.begin) +
                                                   ", but the last window ended at " + text(at_.now));
  if (window.end <= window.begin)
    throw ProtocolError(Violation::wrong_time, "window.end is " + text(window.end) +
                                                   ", not after window.begin, " + text(window.begin));
}

void Progress::expect_now(Nanoseconds now) const {
  if (now != at_.now)
    throw ProtocolError(Violation::wrong_time, "time is " + text(now) + ", expected " + text(at_.now));
}

void Progress::expect_same(const Window& answered, const Window& ordered) const {
  if (answered.index != ordered.index)
    throw ProtocolError(Violation::wrong_window, "window.index is " + std::to_string(answered.index) +
                                                     ", ordered was " + std::to_string(ordered.index));
  if (answered.begin != ordered.begin)
    throw ProtocolError(Violation::wrong_time,
                        "window.begin is " + text(answered.begin) + ", ordered was " + text(ordered.begin));
  if (answered.end != ordered.end)
    throw ProtocolError(Violation::wrong_time,
                        "window.end is " + text(answered.end) + ", ordered was " + text(ordered.end));
}

void Progress::complete(const Window& window) {
  at_ = {at_.window + 1, window.end, 0};
}

void Progress::resume(std::uint64_t windows, Nanoseconds now) {
  if (at_.window != 0 || at_.now != Nanoseconds{})
    throw ProtocolError(Violation::not_allowed,
                        "resume comes after window " + std::to_string(at_.window - 1));
  at_ = {windows, now, 0};
}

void Progress::save() {
  saved_ = at_;
  has_saved_ = true;
}

void Progress::restore() {
  if (!has_saved_) throw ProtocolError(Violation::not_allowed, "restore comes before the first save");
  ++saved_.iteration;
  at_ = saved_;
}

bool Progress::use_snapshot(Nanoseconds time) {
  if (snapshot_ == time) {
    snapshot_.reset();
    return true;
  }
  expect_now(time);
  return false;
}

}  // namespace tandem::protocol
