#include "protocol/shm/heartbeat.hpp"

#include <algorithm>

#include "protocol/channel.hpp"

namespace tandem::protocol::shm {
namespace {

using namespace std::chrono_literals;

void count_up(std::atomic<std::uint32_t>& word) {
  // 0 means that the end never beats.
  if (word.fetch_add(1, std::memory_order_relaxed) + 1 == 0) word.fetch_add(1);
}

}  // namespace

Heartbeat::Heartbeat(std::atomic<std::uint32_t>& own, const std::atomic<std::uint32_t>& peers,
                     std::chrono::milliseconds lease)
    : own_(own), peers_(peers), lease_(lease) {
  count_up(own_);
  thread_ = std::jthread([this](const std::stop_token& stop) { beat(stop); });
}

void Heartbeat::beat(const std::stop_token& stop) {
  const Clock::duration period = lease_ > 0ms ? std::clamp<Clock::duration>(lease_ / 8, 5ms, 100ms) : 100ms;
  Clock::duration silence{};
  std::uint32_t heard = 0;
  Clock::time_point before = Clock::now();
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    sleep_.wait_for(lock, stop, period, [] { return false; });
    count_up(own_);
    const Clock::time_point now = Clock::now();
    const std::uint32_t beats = peers_.load(std::memory_order_relaxed);
    if (beats != heard || beats == 0 || lease_ == 0ms)
      silence = {};
    else
      // Counts no more time than this thread has listened: where both ends were suspended, neither
      // blames the other.
      silence += std::min(now - before, 2 * period);
    heard = beats;
    before = now;
    if (silence >= lease_ && silence > 0ms) silent_ = true;
  }
}

}  // namespace tandem::protocol::shm
