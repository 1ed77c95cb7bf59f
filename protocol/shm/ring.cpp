#include "protocol/shm/ring.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "common/error.hpp"
#include "protocol/frame.hpp"

namespace tandem::protocol::shm {
namespace {

using namespace std::chrono_literals;

// Well below the 1 s of the contract, and rare enough to cost nothing.
constexpr auto check_interval = 20ms;
// Long frames are published to the reader in pieces, so that reader and writer copy concurrently.
constexpr std::size_t piece = 64 * 1024;
// Memory that is allocated for a frame before its first byte has arrived [bytes].
constexpr std::size_t trusted_size = std::size_t{1} << 20;

// The futex uses CLOCK_MONOTONIC with a relative time, so that a change of the wall clock has no effect. The
// word is in memory that two processes map, hence no FUTEX_PRIVATE_FLAG.
long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* time) {
  return syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), operation, value, time, nullptr, 0);
}

// Either the sleeper sees the change, or the thread that made it sees the sleeper: all four accesses are
// sequentially consistent (`ready` reads the counter that the other side stores before it rings).
template <class Ready>
void sleep_on(Doorbell& bell, const Ready& ready, Clock::duration time) {
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
  if (ns <= 0) return;
  bell.sleepers.store(1);
  const std::uint32_t seen = bell.rings.load();
  if (!ready()) {
    const timespec relative{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
    futex(bell.rings, FUTEX_WAIT, seen, &relative);
  }
  bell.sleepers.store(0);
}

void ring_bell(Doorbell& bell) {
  if (bell.sleepers.load() == 0) return;
  bell.rings.fetch_add(1);
  futex(bell.rings, FUTEX_WAKE, 1, nullptr);
}

}  // namespace

template <class Ready>
Waiter::Outcome Waiter::wait(Doorbell& bell, const Ready& ready, Deadline deadline) {
  if (ready()) return Outcome::ready;
  const Clock::time_point begin = Clock::now();
  for (Clock::time_point now = begin;;) {
    const Deadline slice = std::min(deadline, now + check_interval);
    const bool done = spinner_.spin(ready, now, slice);
    if (!done && spinner_.may_sleep()) sleep_on(bell, ready, slice - Clock::now());
    now = Clock::now();
    if (ready()) {
      spinner_.learn(now - begin);
      return Outcome::ready;
    }
    // Data that the peer wrote before it ended are still delivered: check the peer first, then the ring
    // once more.
    if (peer_gone_()) return ready() ? Outcome::ready : Outcome::gone;
    if (now >= deadline) return Outcome::deadline;
  }
}

std::size_t RingWriter::room() const {
  const std::uint64_t used = at_ - head_.read.load();
  if (used > capacity_) throw Error(ErrorCode::protocol, "the shared memory's counters are damaged");
  return capacity_ - used;
}

void RingWriter::publish() {
  if (published_ == at_) return;
  published_ = at_;
  head_.written.store(at_);
  ring_bell(head_.data);
}

Waiter::Outcome RingWriter::append(std::span<const std::byte> data, Deadline deadline) {
  while (!data.empty()) {
    std::size_t free = room();
    if (free == 0) {
      publish();
      const auto outcome = waiter_.wait(
          head_.room, [this] { return room() > 0; }, deadline);
      if (outcome != Waiter::Outcome::ready) return outcome;
      free = room();
    }
    const std::size_t offset = at_ & (capacity_ - 1);
    const std::size_t n = std::min({data.size(), free, capacity_ - offset, piece});
    std::memcpy(bytes_ + offset, data.data(), n);
    at_ += n;
    data = data.subspan(n);
    if (at_ - published_ >= piece) publish();
  }
  return Waiter::Outcome::ready;
}

Waiter::Outcome RingWriter::write(std::span<const std::span<const std::byte>> parts, Deadline deadline) {
  std::uint64_t size = 0;
  for (const auto& part : parts) size += part.size();
  auto outcome = append(std::as_bytes(std::span(&size, 1)), deadline);
  for (const auto& part : parts)
    if (outcome == Waiter::Outcome::ready) outcome = append(part, deadline);
  publish();
  return outcome;
}

std::size_t RingReader::filled() const {
  const std::uint64_t waiting = head_.written.load() - at_;
  if (waiting > capacity_) throw Error(ErrorCode::protocol, "the shared memory's counters are damaged");
  return waiting;
}

void RingReader::release() {
  if (released_ == at_) return;
  released_ = at_;
  head_.read.store(at_);
  ring_bell(head_.room);
}

Waiter::Outcome RingReader::take(std::span<std::byte> data, Deadline deadline) {
  while (!data.empty()) {
    std::size_t waiting = filled();
    if (waiting == 0) {
      release();
      const auto outcome = waiter_.wait(
          head_.data, [this] { return filled() > 0; }, deadline);
      if (outcome != Waiter::Outcome::ready) return outcome;
      waiting = filled();
    }
    const std::size_t offset = at_ & (capacity_ - 1);
    const std::size_t n = std::min({data.size(), waiting, capacity_ - offset, piece});
    std::memcpy(data.data(), bytes_ + offset, n);
    at_ += n;
    data = data.subspan(n);
    if (at_ - released_ >= piece) release();
  }
  return Waiter::Outcome::ready;
}

Waiter::Outcome RingReader::wait(Deadline deadline) {
  return waiter_.wait(
      head_.data, [this] { return filled() > 0; }, deadline);
}

Waiter::Outcome RingReader::read(std::vector<std::byte>& frame, Deadline deadline) {
  std::uint64_t size = 0;
  auto outcome = take(std::as_writable_bytes(std::span(&size, 1)), deadline);
  if (outcome != Waiter::Outcome::ready) return outcome;
  if (size > max_payload + sizeof(FrameHeader))
    throw Error(ErrorCode::protocol, "a frame of " + std::to_string(size) + " bytes is announced", {},
                "messages end at 4.3 GB, which a frame of 76.7 million spheres fills: use fewer, or leave "
                "them out of frames (\"output\": {\"particles\": false})");
  // Memory is allocated only as the bytes of this frame arrive, whatever size is announced.
  for (std::size_t got = 0; got < size || frame.size() != size;) {
    frame.resize(std::min<std::size_t>(size, std::max({frame.capacity(), 2 * got, trusted_size})));
    outcome = take(std::span(frame).subspan(got), deadline);
    if (outcome != Waiter::Outcome::ready) break;
    got = frame.size();
  }
  release();
  return outcome;
}

}  // namespace tandem::protocol::shm
