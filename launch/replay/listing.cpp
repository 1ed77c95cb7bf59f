#include <fmt/format.h>

#include "launch/replay/replay.hpp"
#include "protocol/recorder.hpp"

namespace tandem::launch {

std::string cut_off(std::uint64_t not_read) {
  return fmt::format("the file is cut off or damaged: its last {} bytes are no whole frame, and are not read",
                     not_read);
}

void list_recording(const std::filesystem::path& recording) {
  using protocol::Direction;
  protocol::RecordingReader reader(recording, protocol::RecordingReader::Part::headers);
  fmt::print("{:>12}  {:<24}  {:<11}  {:>8}  {:>9}  {:>12}\n", "time [s]", "from and to", "message", "window",
             "iteration", "bytes");
  for (protocol::RecordedFrame frame; reader.next(frame);) {
    if (frame.missing) {
      fmt::print("{:>12}  {} frames of windows {} to {} are missing\n", "...", frame.missing->frames,
                 frame.missing->first_window, frame.missing->last_window);
      continue;
    }
    const char* participant = protocol::name(frame.role);
    const bool ordered = frame.direction == Direction::to_participant;
    fmt::print("{:>12.6f}  {:<24}  {:<11}  {:>8}  {:>9}  {:>12}{}\n", 1e-9 * static_cast<double>(frame.time),
               fmt::format("{} -> {}", ordered ? "tandem" : participant, ordered ? participant : "tandem"),
               protocol::name(frame.header.kind), frame.header.window, frame.header.iteration,
               sizeof(protocol::FrameHeader) + frame.header.payload_size,
               frame.has_payload ? "" : "  payload not kept");
  }
  if (reader.not_read() > 0) fmt::print("{}\n", cut_off(reader.not_read()));
}

}  // namespace tandem::launch
