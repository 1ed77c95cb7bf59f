// Plays the coordinator's side of a recording against one participant, and compares its answers with the
// recorded ones to the bit, up to the first difference.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "protocol/channel.hpp"
#include "protocol/recorder.hpp"

namespace tandem::protocol {

struct ReplayResult {
  std::size_t compared = 0;      // answers that are equal
  std::uint64_t windows = 0;     // number of windows that they are about
  std::size_t not_kept = 0;      // answers whose values the recording lacks
  std::size_t not_possible = 0;  // orders to linearise and of snapshots, to a participant that cannot
  std::size_t not_repeated = 0;  // orders to write a restart file, which would replace that of the run
  std::optional<std::string> difference;  // a sentence about the first
  std::optional<std::string> ending;      // a sentence where the recording does not end with the report
};

class Replay {
 public:
  // Reads the recording once. Throws Error{usage} where it cannot be replayed: it is none, it has no frames
  // of this role, or frames are missing that the participant needs.
  Replay(const std::filesystem::path& file, Role role);

  // Folder from which the participant restores its state at the start; empty: none.
  const std::filesystem::path& state_folder() const { return state_folder_; }

  // Bytes at the end of the file that are no whole record: it is cut off or damaged there.
  std::uint64_t not_read() const { return not_read_; }

  // Throws ProtocolError where the participant cannot be admitted. What it does wrong later, or its loss, is
  // a difference. `patience` bounds each wait for an answer.
  ReplayResult against(Channel& channel, std::chrono::milliseconds patience) const;

 private:
  std::filesystem::path file_;
  Role role_;
  std::uint64_t needed_ = 0;    // capabilities
  std::uint64_t not_read_ = 0;  // [bytes]
  std::filesystem::path state_folder_;
};

}  // namespace tandem::protocol
