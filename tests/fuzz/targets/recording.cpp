// Recordings of all frames of a run. Writing the frames that were read must give the same bytes.
#include <cstring>

#include "common/error.hpp"
#include "protocol/frame.hpp"
#include "protocol/recorder.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/frames_of_messages.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace recording_part {

using namespace protocol;

class RecordingTarget : public Target {
 public:
  explicit RecordingTarget(const std::filesystem::path& folder) : file_(folder / "recording") {}

  void run(std::span<const std::byte> input) override {
    put(file_, input);
    RecordingReader reader(file_);
    std::size_t bytes = 16;  // size of the header
    for (RecordedFrame frame; reader.next(frame);) {
      bytes += 24 + frame.frame.size();
      expect(bytes <= input.size(), "frames are longer than their file");
      const auto at = input.subspan(bytes - frame.frame.size(), frame.frame.size());
      expect(std::memcmp(frame.frame.data(), at.data(), at.size()) == 0,
             "a frame has other bytes than its file");
    }
    for (const Role role : {Role::mbd, Role::dem}) {
      ReplayChannel replay(file_, role);
      protocol::Bytes frame;
      try {
        while (replay.wait({})) replay.receive(frame, {});
      } catch (const Error&) {
        // The end of each recording.
      }
    }
  }

 private:
  std::filesystem::path file_;
};

std::vector<Bytes> recordings(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "recording";
  {
    Recorder recorder(file);
    for (const protocol::Bytes& frame : frames_of_messages()) {
      const auto bytes = std::span(frame);
      recorder.record(Direction::to_coordinator, Role::mbd, bytes.first(sizeof(FrameHeader)),
                      payload_of(bytes));
      recorder.record(Direction::to_participant, Role::dem, bytes.first(sizeof(FrameHeader)),
                      payload_of(bytes));
    }
  }
  Bytes whole = get(file);
  // Fixed times of day, so that the corpus is reproducible.
  for (std::size_t at = 16; at + 24 <= whole.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, whole.data() + at + 16, sizeof size);
    std::memset(whole.data() + at, 0, 8);
    at += 24 + size;
  }
  return {whole};
}

}  // namespace recording_part

TargetKind recording_target() {
  using namespace recording_part;
  return {.name = "recording", .corpus = recordings, .make = make_target<RecordingTarget>};
}

}  // namespace tandem::fuzz
