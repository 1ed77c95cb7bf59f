// The memory that two processes share: one plain struct with atomics, then the bytes of two rings. The
// creator fills in the head before it sends the descriptor, so that the other end never sees it incomplete.
#pragma once

#include <atomic>
#include <boost/interprocess/mapped_region.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "protocol/fd.hpp"

namespace tandem::protocol::shm {

// The word on which one end sleeps. `rings` is the futex word; the other end makes a system call only if an
// end sleeps.
struct Doorbell {
  std::atomic<std::uint32_t> rings = 0, sleepers = 0;
};

// One direction: a ring of bytes with one writer and one reader. Fields written by different sides are in
// different cache lines.
struct alignas(64) RingHead {
  std::atomic<std::uint64_t> written = 0;           // [bytes] since the start
  alignas(64) std::atomic<std::uint64_t> read = 0;  // [bytes] since the start
  alignas(64) Doorbell data;                        // the reader sleeps here
  alignas(64) Doorbell room;                        // the writer sleeps here
};

// Mark of this layout. A participant reads it before hello, so that it cannot depend on the version of the
// creator; it is what participants of 1.3 expect here, the layout hash of their protocol.
inline constexpr std::uint64_t segment_layout = 0x6da5c5873d6d05de;

struct SegmentHead {
  std::uint64_t magic = 0;
  std::uint64_t layout = 0;              // segment_layout
  std::uint64_t head_bytes = 0;          // sizeof(SegmentHead)
  std::uint64_t ring_bytes = 0;          // per direction, a power of two
  std::atomic<std::uint32_t> ready = 0;  // 1, written last
  // Since 1.4; a creator of 1.3 leaves zeros here, and a peer of 1.3 leaves its own word at 0.
  std::uint32_t lease = 0;  // [ms] of silence after which a peer is lost; 0: none
  std::atomic<std::uint32_t> coordinator_beats = 0, participant_beats = 0;
  RingHead to_participant, to_coordinator;
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free &&
              std::atomic<std::uint32_t>::is_always_lock_free);
static_assert(sizeof(SegmentHead) == 64 + 2 * sizeof(RingHead) && sizeof(RingHead) == 256);

// Memory without a name, readable and writable by this user only, with a sealed size: a peer cannot cause an
// access error here by truncating it. `lease`: see SegmentHead.
Fd create_memory(std::size_t ring_bytes, std::chrono::milliseconds lease = {});

// A mapped segment, checked.
class Segment {
 public:
  explicit Segment(const Fd& memory);
  SegmentHead& head() const { return *static_cast<SegmentHead*>(region_.get_address()); }
  std::byte* ring(int index) const {
    return static_cast<std::byte*>(region_.get_address()) + sizeof(SegmentHead) + index * head().ring_bytes;
  }

 private:
  boost::interprocess::mapped_region region_;
};

}  // namespace tandem::protocol::shm
