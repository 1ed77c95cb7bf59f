// Recordings of all frames of a run. Writing the frames that were read must give the same bytes.
#include <cstring>

#include "common/error.hpp"
#include "protocol/frame.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/recorder.hpp"
#include "protocol/replay.hpp"
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
      const auto in_place =
          frame.missing ? std::as_bytes(std::span(&*frame.missing, 1)) : std::span(frame.frame);
      bytes += 24 + in_place.size();
      expect(bytes <= input.size(), "frames are longer than their file");
      const auto at = input.subspan(bytes - in_place.size(), in_place.size());
      expect(std::memcmp(in_place.data(), at.data(), at.size()) == 0,
             "a frame has other bytes than its file");
    }
    // Refuses what it cannot replay; the participant here is gone, so that the rest ends at once.
    for (const Role role : {Role::mbd, Role::dem}) {
      try {
        const Replay replay(file_, role);
        auto [own, theirs] = create_inproc("participant");
        theirs.reset();
        replay.against(*own, std::chrono::milliseconds(1));
      } catch (const Error&) {
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
