// `tandem replay`.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "protocol/messages.hpp"

namespace tandem::launch {

struct ReplayOptions {
  std::filesystem::path recording;
  protocol::Role role{};
  std::string
      server;  // command of the participant; empty, or the name of our server: our solver in this process
  bool stream = false;  // the server is reached over its standard input and output, not over shared memory
  std::chrono::milliseconds patience{60'000};  // limit of one wait for an answer
};

// Replays a recording against one participant, and prints what came out. Returns 0 where all answers are
// equal, and 1 at the first difference; throws Error where the recording cannot be replayed or the
// participant cannot be started.
int replay(const ReplayOptions& options);

// Prints a line for each frame of a recording.
void list_recording(const std::filesystem::path& recording);
// The sentence about the end of a recording that is no whole frame.
std::string cut_off(std::uint64_t not_read);

}  // namespace tandem::launch
