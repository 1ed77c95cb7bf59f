// The first and the last frames of a session in memory, within a fixed number of bytes: what a failed run
// leaves for replay (docs/replay.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "protocol/recorder.hpp"

namespace tandem::protocol {

// Registration and configuration of each participant are always kept. Of all other frames the last are kept,
// as whole windows. A payload that is larger than a sixteenth of `bytes` is left out, and its header kept, so
// that one frame of very many spheres does not displace all windows.
class LastFrames : public FrameSink {
 public:
  // Half of the bytes are for the beginning, half for the end; rounded down to a power of two.
  explicit LastFrames(std::size_t bytes = std::size_t{16} << 20);

  void record(Direction direction, Role role, std::span<const std::byte> header,
              std::span<const std::byte> payload) override;
  bool empty() const;
  // Bytes in use, at most those of the constructor.
  std::size_t size() const;
  // Writes them as a recording, which is complete or absent. Throws Error{resource}.
  void write(const std::filesystem::path& file) const;

 private:
  struct Entry {
    std::int64_t time = 0;  // [ns]
    Direction direction{};
    Role role{};
    std::uint64_t window = 0;
    std::uint64_t size = 0;  // [bytes]
  };
  static bool belongs_to_the_beginning(Kind kind);
  void put(const void* data, std::size_t size);
  void get(std::uint64_t at, void* data, std::size_t size) const;
  Entry front() const;
  void drop_front();

  const std::size_t half_, largest_payload_;
  mutable std::mutex mutex_;
  std::optional<Clock::time_point> start_;
  std::vector<std::byte> beginning_;  // entries, each followed by its frame
  // Ring of the same; a position grows for ever, and its place is the remainder. The memory is that of the
  // pages that were written.
  std::unique_ptr<std::byte[]> ring_;
  std::uint64_t begin_ = 0, end_ = 0;
  MissingFrames missing_;
};

}  // namespace tandem::protocol
