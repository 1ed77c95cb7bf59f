// Records every frame of a session, with direction, peer and time, and reads recordings (replay.hpp).
//
// File: head {magic "TNDMREC2", layout hash u64}, then records {time i64 [ns, monotonic, from the first
// frame], direction u32, role u32, size u64, frame}. A frame may be its header alone, where its payload was
// too large to be kept; its size is then less than the header announces. A record with direction 2 has a
// MissingFrames in place of a frame. Files with magic "TNDMREC1" have neither.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/codec.hpp"
#include "protocol/frame.hpp"

namespace tandem::protocol {

enum class Direction : std::uint32_t { to_participant = 0, to_coordinator = 1 };

// Frames that were sent between two others of a recording, and are not in it.
struct MissingFrames {
  std::uint64_t frames = 0;
  std::uint64_t first_window = 0, last_window = 0;  // some or all of their frames are missing
};

// Receives the frames of a session. Any thread.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void record(Direction direction, Role role, std::span<const std::byte> header,
                      std::span<const std::byte> payload) = 0;
};

// Writes a recording, record by record.
class RecordingWriter {
 public:
  // Replaces an earlier file.
  explicit RecordingWriter(const std::filesystem::path& file);
  // Each throws Error{resource} when the disk is full. The parts form the frame.
  void write(std::int64_t time, Direction direction, Role role,
             std::span<const std::span<const std::byte>> parts);
  void write(const MissingFrames& missing);
  void close();

 private:
  void expect_good();

  std::filesystem::path path_;
  std::ofstream file_;
};

// Keeps all frames in a file, from the first on.
class Recorder : public FrameSink {
 public:
  // Replaces an earlier recording.
  explicit Recorder(const std::filesystem::path& file);
  // Throws Error{usage} where the file is there and is no recording: it would be lost.
  static void expect_replaceable(const std::filesystem::path& file);
  void record(Direction direction, Role role, std::span<const std::byte> header,
              std::span<const std::byte> payload) override;

 private:
  std::mutex mutex_;
  RecordingWriter writer_;
  std::optional<Clock::time_point> start_;
};

struct RecordedFrame {
  std::int64_t time = 0;  // [ns]
  Direction direction{};
  Role role{};
  FrameHeader header;
  Bytes frame;         // header and payload; the header alone where a reader reads headers only
  bool has_payload{};  // whether the recording has the payload
  std::optional<MissingFrames> missing;  // in place of a frame: everything above is then empty
};

class RecordingReader {
 public:
  enum class Part { whole, headers };
  // Throws Error{usage} where it is not a recording, or one with a layout of the protocol that this program
  // does not support.
  explicit RecordingReader(const std::filesystem::path& file, Part part = Part::whole);
  // Returns false at the end; a truncated last record ends the recording and is not returned. Throws
  // Error{usage} where a record is damaged.
  bool next(RecordedFrame& frame);
  // Bytes behind the last whole record, once next() has returned false: the file is cut off or damaged there.
  std::uint64_t not_read() const { return not_read_; }

 private:
  [[noreturn]] void fail(const std::string& problem) const;

  std::filesystem::path path_;
  Part part_;
  std::ifstream file_;
  std::uint64_t size_ = 0, at_ = 0, not_read_ = 0;  // [bytes]
  std::uint64_t records_ = 0;
};

}  // namespace tandem::protocol
