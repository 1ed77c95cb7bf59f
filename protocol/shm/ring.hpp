// One direction of the shared memory: frames as a stream of bytes {size u64, bytes}, through a ring that one
// process writes and the other reads. A frame larger than the ring streams through it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/shm/segment.hpp"
#include "protocol/waiting.hpp"

namespace tandem::protocol::shm {

// Waits for one end of a ring. `peer_gone` reports whether the other side is gone; it is called at least
// every 20 ms.
class Waiter {
 public:
  Waiter(WaitPolicy policy, std::function<bool()> peer_gone)
      : spinner_(policy), peer_gone_(std::move(peer_gone)) {}
  enum class Outcome { ready, deadline, gone };
  template <class Ready>
  Outcome wait(Doorbell& bell, const Ready& ready, Deadline deadline);

 private:
  Spinner spinner_;
  std::function<bool()> peer_gone_;
};

class RingWriter {
 public:
  RingWriter(RingHead& head, std::byte* bytes, std::size_t capacity, WaitPolicy policy,
             std::function<bool()> peer_gone)
      : head_(head), bytes_(bytes), capacity_(capacity), waiter_(policy, std::move(peer_gone)) {}
  Waiter::Outcome write(std::span<const std::span<const std::byte>> parts, Deadline deadline);

 private:
  Waiter::Outcome append(std::span<const std::byte> data, Deadline deadline);
  void publish();
  std::size_t room() const;
  RingHead& head_;
  std::byte* bytes_;
  std::size_t capacity_;
  Waiter waiter_;
  std::uint64_t at_ = 0;         // [bytes] written since the start
  std::uint64_t published_ = 0;  // of these, visible to the reader
};

class RingReader {
 public:
  RingReader(RingHead& head, const std::byte* bytes, std::size_t capacity, WaitPolicy policy,
             std::function<bool()> peer_gone)
      : head_(head), bytes_(bytes), capacity_(capacity), waiter_(policy, std::move(peer_gone)) {}
  // Waits for the first bytes of a frame.
  Waiter::Outcome wait(Deadline deadline);
  Waiter::Outcome read(std::vector<std::byte>& frame, Deadline deadline);

 private:
  Waiter::Outcome take(std::span<std::byte> data, Deadline deadline);
  void release();
  std::size_t filled() const;
  RingHead& head_;
  const std::byte* bytes_;
  std::size_t capacity_;
  Waiter waiter_;
  std::uint64_t at_ = 0;        // [bytes] read since the start
  std::uint64_t released_ = 0;  // of these, released to the writer
};

}  // namespace tandem::protocol::shm
