// Single frames of the protocol: header, payload, values. An accepted frame must have finite numbers, and its
// encoding must give the same bytes.
#include "protocol/codec.hpp"
#include "protocol/checks.hpp"
#include "protocol/frame.hpp"
#include "protocol/violation.hpp"
#include "tests/fuzz/targets/frames_of_messages.hpp"
#include "tests/fuzz/targets/targets.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tandem::fuzz {
namespace codec_part {

using namespace protocol;

// Records of two 32-bit words followed by floating-point numbers.
template <class Record>
void expect_numbers(const std::vector<Record>& records, const char* sentence) {
  for (const Record& record : records) {
    std::array<double, sizeof(Record) / sizeof(double)> numbers;
    std::memcpy(numbers.data(), &record, sizeof record);
    expect(std::all_of(numbers.begin() + 1, numbers.end(), [](double x) { return std::isfinite(x); }),
           sentence);
  }
}

class CodecTarget : public Target {
 public:
  CodecTarget() {
    Configured configured;
    decode(payload_of(frames_of_messages()[4]), configured);
    bodies_.assign(configured.boundary);
  }

  void run(std::span<const std::byte> input) override {
    const FrameHeader header = open_frame(input, "peer");
    payload_ = payload_of(input);
    switch (header.kind) {
      case Kind::hello:
        return take(hello_);
      case Kind::refuse:
      case Kind::failure:
        return take(failure_);
      case Kind::configure:
        take(configuration_);
        return check_values(configuration_);
      case Kind::configured:
        take(configured_);
        check_values(configured_);
        expect_numbers(configured_.boundary, "a start state with numbers that are not finite is accepted");
        return BoundaryBodies().assign(configured_.boundary);
      case Kind::predict:
      case Kind::extrapolate:
        return take(window_);
      case Kind::motion:
      case Kind::advance_dem:
        take(motion_);
        check_values(motion_);
        bodies_.expect_all(motion_.bodies);
        return expect_numbers(motion_.bodies, "a motion with numbers that are not finite is accepted");
      case Kind::advance_mbd:
      case Kind::load:
        take(load_);
        check_values(load_);
        check_account(load_);
        bodies_.expect_some(load_.bodies);
        return expect_numbers(load_.bodies, "a load with numbers that are not finite is accepted");
      case Kind::tangents:
        take(tangents_);
        check_values(tangents_);
        bodies_.expect_some(tangents_.bodies);
        return expect_numbers(tangents_.bodies, "a tangent with numbers that are not finite is accepted");
      case Kind::control:
        take(control_);
        return check_values(control_);
      case Kind::checkpoint:
      case Kind::resume:
        take(checkpoint_);
        return check_values(checkpoint_);
      case Kind::observe:
      case Kind::snapshot:
        return take(time_);
      case Kind::bodies:
        take(bodies_frame_);
        return check_values(bodies_frame_);
      case Kind::particles:
        take(particles_);
        check_values(particles_);
        return expect(
            std::ranges::all_of(particles_.radius, [](float r) { return r > 0 && std::isfinite(r); }),
            "a radius that is none is accepted");
      case Kind::report:
        return take(report_);
      case Kind::welcome:
      case Kind::save:
      case Kind::restore:
      case Kind::done:
      case Kind::finish:
      case Kind::linearise:
        return decode_nothing(payload_);
    }
    throw ProtocolError(Violation::not_allowed, "there is no message of this code");
  }

 private:
  template <class T>
  void take(T& value) {
    decode(payload_, value);
    encode(again_, value);
    expect(std::ranges::equal(again_, payload_), "what is decoded is encoded to other bytes");
  }

  std::span<const std::byte> payload_;
  protocol::Bytes again_;
  BoundaryBodies bodies_;
  Hello hello_;
  Failure failure_;
  Configuration configuration_;
  Configured configured_;
  Window window_;
  MotionSet motion_;
  LoadSet load_;
  TangentSet tangents_;
  ControlSet control_;
  protocol::Checkpoint checkpoint_;
  Nanoseconds time_;
  BodiesFrame bodies_frame_;
  ParticlesFrame particles_;
  Report report_;
};

// Half of the frames get the right size and checksum.
Fate finish_frame(Random& random, Bytes& input) {
  if (random.one_in(2)) return Fate::refused;
  reseal(input);
  return Fate::open;
}

}  // namespace codec_part

void reseal(Bytes& frame) {
  using namespace codec_part;
  FrameHeader header;
  if (frame.size() < sizeof header) return;
  std::memcpy(&header, frame.data(), sizeof header);
  seal(header, payload_of(frame));
  std::memcpy(frame.data(), &header, sizeof header);
}

TargetKind codec_target() {
  using namespace codec_part;
  return {.name = "codec",
          .corpus = [](const std::filesystem::path&) { return frames_of_messages(); },
          .make = make_target<CodecTarget>,
          .finish = finish_frame};
}

}  // namespace tandem::fuzz
