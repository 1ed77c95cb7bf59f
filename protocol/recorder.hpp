// Records every frame of a session, with direction, peer and time, and reads recordings: for inspection, and
// to run one participant again without the others (ReplayChannel).
//
// File: head {magic "TNDMREC1", layout hash u64}, then records {time i64 [ns, monotonic, from the first
// frame], direction u32, role u32, size u64, frame}.
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

namespace tandem::protocol {

enum class Direction : std::uint32_t { to_participant = 0, to_coordinator = 1 };

class Recorder {
 public:
  // Replaces an earlier recording.
  explicit Recorder(const std::filesystem::path& file);
  // Throws Error{usage} where the file is there and is no recording: it would be lost.
  static void expect_replaceable(const std::filesystem::path& file);
  // Any thread. Throws Error{resource} when the disk is full.
  void record(Direction direction, Role role, std::span<const std::byte> header,
              std::span<const std::byte> payload);

 private:
  std::mutex mutex_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::optional<Clock::time_point> start_;
};

struct RecordedFrame {
  std::int64_t time = 0;  // [ns]
  Direction direction{};
  Role role{};
  Bytes frame;
};

class RecordingReader {
 public:
  // Throws Error{usage} where it is not a recording.
  explicit RecordingReader(const std::filesystem::path& file);
  // Returns false at the end; a truncated last record ends the recording and is not returned.
  bool next(RecordedFrame& frame);

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;  // [bytes]
};

// A channel whose coordinator is a recording: serve() on it makes the solver repeat the recorded run.
class ReplayChannel : public Channel {
 public:
  ReplayChannel(const std::filesystem::path& file, Role role);

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override;
  bool wait(Deadline deadline) override;
  void receive(Bytes& frame, Deadline deadline) override;
  bool peer_gone() noexcept override { return false; }
  const char* transport() const override { return "replay"; }
  const std::string& peer() const override { return peer_; }

  // Number of answers with a solver's results (configured and report contain times of day and machine, hello
  // a pid).
  std::size_t compared() const { return compared_; }
  // Of these, the number that differs from the recording in at least one bit.
  std::size_t different() const { return different_; }

 private:
  std::vector<RecordedFrame> frames_;
  std::size_t at_ = 0;  // the next frame
  std::size_t compared_ = 0, different_ = 0;
  std::string peer_ = "recording";
};

}  // namespace tandem::protocol
