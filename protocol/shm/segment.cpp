#include "protocol/shm/segment.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <bit>
#include <cstring>
#include <new>

#include "common/error.hpp"

namespace tandem::protocol::shm {
namespace {

namespace bip = boost::interprocess;

constexpr std::uint64_t segment_magic = 0x314d485344544e54;  // "TNTDSHM1"

// The interface that mapped_region requires of a mappable object.
class Memory {
 public:
  explicit Memory(int fd) : fd_(fd) {}
  bip::mapping_handle_t get_mapping_handle() const { return {fd_, false}; }

 private:
  int fd_;
};

Error damaged(const std::string& what) {
  return Error(ErrorCode::protocol, "the shared memory " + what, {},
               "start both sides from the same release");
}

bip::mapped_region map(int fd, std::size_t size) {
  try {
    return bip::mapped_region(Memory(fd), bip::read_write, 0, size);
  } catch (const bip::interprocess_exception& e) {
    throw Error(ErrorCode::resource, std::string("shared memory cannot be mapped: ") + e.what());
  }
}

std::size_t checked_size(int fd) {
  struct stat status {};
  if (fstat(fd, &status) != 0 || status.st_size < static_cast<off_t>(sizeof(SegmentHead)))
    throw damaged("is too small to be ours");
  if ((fcntl(fd, F_GET_SEALS) & F_SEAL_SHRINK) == 0) throw damaged("could shrink while it is used");
  return static_cast<std::size_t>(status.st_size);
}

}  // namespace

Fd create_memory(std::size_t ring_bytes, std::chrono::milliseconds lease) {
  if (!std::has_single_bit(ring_bytes) || ring_bytes < 4096)
    throw Error(ErrorCode::internal,
                "a ring of " + std::to_string(ring_bytes) + " bytes is no power of two >= 4096");
  const std::size_t size = sizeof(SegmentHead) + 2 * ring_bytes;
  Fd fd(memfd_create("tandem", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  // Allocates the memory now: an error here is better than a signal at the first access.
  const int problem = !fd                           ? errno
                      : fchmod(fd.get(), 0600) != 0 ? errno
                                                    : posix_fallocate(fd.get(), 0, static_cast<off_t>(size));
  if (problem != 0)
    throw Error(ErrorCode::resource,
                std::to_string(size) + " bytes of shared memory cannot be had: " + std::strerror(problem));
  if (fcntl(fd.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
    throw Error(ErrorCode::resource, std::string("shared memory cannot be sealed: ") + std::strerror(errno));
  const bip::mapped_region region = map(fd.get(), size);
  auto* head = new (region.get_address()) SegmentHead;
  head->magic = segment_magic;
  head->layout = segment_layout;
  head->head_bytes = sizeof(SegmentHead);
  head->ring_bytes = ring_bytes;
  head->lease = static_cast<std::uint32_t>(lease.count());
  head->ready.store(1, std::memory_order_release);
  return fd;
}

Segment::Segment(const Fd& memory) {
  const std::size_t size = checked_size(memory.get());
  region_ = map(memory.get(), size);
  const SegmentHead& h = head();
  if (h.ready.load(std::memory_order_acquire) != 1 || h.magic != segment_magic) throw damaged("is not ours");
  if (h.head_bytes != sizeof(SegmentHead) || h.layout != segment_layout)
    throw damaged("has another layout than this program's");
  if (!std::has_single_bit(h.ring_bytes) || size != sizeof(SegmentHead) + 2 * h.ring_bytes)
    throw damaged("has the wrong size");
}

}  // namespace tandem::protocol::shm
