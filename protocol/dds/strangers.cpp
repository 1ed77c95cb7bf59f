#include "protocol/dds/strangers.hpp"

#include <algorithm>
#include <bit>

#include "common/log.hpp"

namespace tandem::protocol::dds {

void Strangers::report(const std::string& who, const char* why) {
  const std::lock_guard lock(mutex_);
  ++count_;
  if (last_.empty() || std::has_single_bit(count_)) {
    last_ = who + ": " + why;
    // The name is untrusted, and the log is read in a terminal.
    std::ranges::replace_if(
        last_, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  }
}

void Strangers::log_new(const std::string& run) {
  std::string line;
  std::uint64_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    if (count_ == logged_ || std::bit_width(count_) == std::bit_width(logged_)) return;
    logged_ = count = count_;
    line = last_;
  }
  log::warn("run '{}': refused {} (messages refused so far: {})", run, line, count);
}

std::string Strangers::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

std::uint64_t Strangers::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

}  // namespace tandem::protocol::dds
