// Signs of life over shared memory. A dead peer is detected by its socket and pidfd; one that is stopped, or
// starved by its machine, only by its silence. Each end increments a word in the memory from a separate
// thread, so that a working solver is not silent.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

namespace tandem::protocol::shm {

class Heartbeat {
 public:
  // Starts beating. A peer that has never beaten, such as one of protocol 1.3, is not judged; with `lease`
  // 0 no peer is.
  Heartbeat(std::atomic<std::uint32_t>& own, const std::atomic<std::uint32_t>& peers,
            std::chrono::milliseconds lease);
  ~Heartbeat() = default;

  // Any thread. Whether the peer has been silent for the lease at any time; latched.
  bool silent() const noexcept { return silent_; }

 private:
  void beat(const std::stop_token& stop);

  std::atomic<std::uint32_t>& own_;
  const std::atomic<std::uint32_t>& peers_;
  const std::chrono::milliseconds lease_;
  std::atomic<bool> silent_ = false;
  std::mutex mutex_;
  std::condition_variable_any sleep_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace tandem::protocol::shm
