#include "protocol/recorder.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "protocol/frame.hpp"
#include "protocol/layout.hpp"

namespace tandem::protocol {
namespace {

struct Head {
  char magic[8];
  std::uint64_t layout = 0;
};
struct RecordHead {
  std::int64_t time = 0;
  Direction direction{};
  Role role{};
  std::uint64_t size = 0;
};
static_assert(sizeof(Head) == 16 && sizeof(RecordHead) == 24);

constexpr std::uint64_t largest_recording = std::numeric_limits<std::int64_t>::max();  // read frame by frame
constexpr char magic[8] = {'T', 'N', 'D', 'M', 'R', 'E', 'C', '1'};

template <class T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}
void put(std::ostream& out, std::span<const std::byte> bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}
template <class T>
bool get(std::istream& in, T& value) {
  return static_cast<bool>(in.read(reinterpret_cast<char*>(&value), sizeof value));
}

bool holds_results(Kind kind) {
  return kind == Kind::motion || kind == Kind::load || kind == Kind::bodies || kind == Kind::particles;
}

}  // namespace

void Recorder::expect_replaceable(const std::filesystem::path& file) {
  std::error_code unknown;
  constexpr const char* hint = "give the name of a new file as --record";
  if (!std::filesystem::exists(file, unknown) && !unknown) return;
  expect_input(file, {.code = ErrorCode::usage, .largest = largest_recording, .hint = hint});
  std::ifstream there(file, std::ios::binary);
  char begin[sizeof magic] = {};
  there.read(begin, sizeof begin);
  if (there.gcount() > 0 && std::memcmp(begin, magic, sizeof magic) != 0)
    throw Error(ErrorCode::usage, "is there, and is no recording: it would be overwritten", file.string(),
                hint);
}

Recorder::Recorder(const std::filesystem::path& file) : path_(file) {
  expect_replaceable(file);
  file_.open(file, std::ios::binary);
  Head head{};
  std::memcpy(head.magic, magic, sizeof magic);
  head.layout = layout_hash;
  put(file_, head);
  if (!file_)
    throw Error(ErrorCode::resource, "cannot be written", path_.string(),
                "check folder, permissions and space");
}

void Recorder::record(Direction direction, Role role, std::span<const std::byte> header,
                      std::span<const std::byte> payload) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (!start_) start_ = now;
  const auto time = std::chrono::duration_cast<std::chrono::nanoseconds>(now - *start_).count();
  put(file_, RecordHead{time, direction, role, header.size() + payload.size()});
  put(file_, header);
  put(file_, payload);
  if (!file_)
    throw Error(ErrorCode::resource, "the recording cannot be written any more", path_.string(),
                "free some space, or run without recording");
}

RecordingReader::RecordingReader(const std::filesystem::path& file) : path_(file) {
  expect_input(file, {.code = ErrorCode::usage,
                      .largest = largest_recording,
                      .hint = "give a file made by tandem run --record"});
  file_.open(file, std::ios::binary);
  Head head{};
  if (!get(file_, head) || std::memcmp(head.magic, magic, sizeof magic) != 0)
    throw Error(ErrorCode::usage, "is no recording", path_.string(),
                "give a file made by tandem run --record");
  if (head.layout != layout_hash)
    throw Error(ErrorCode::usage, "was recorded with another layout of the protocol", path_.string(),
                "replay it with the release that recorded it");
  size_ = std::filesystem::file_size(path_);
}

bool RecordingReader::next(RecordedFrame& frame) {
  RecordHead head;
  if (!get(file_, head)) return false;
  if (head.size > max_payload + sizeof(FrameHeader))
    throw Error(ErrorCode::usage, "is damaged: a frame of " + std::to_string(head.size) + " bytes",
                path_.string());
  // The record is truncated; memory is not allocated for the size that it announces.
  if (head.size > size_ - static_cast<std::uint64_t>(file_.tellg())) return false;
  frame.time = head.time;
  frame.direction = head.direction;
  frame.role = head.role;
  frame.frame.resize(head.size);
  return static_cast<bool>(
      file_.read(reinterpret_cast<char*>(frame.frame.data()), static_cast<std::streamsize>(head.size)));
}

ReplayChannel::ReplayChannel(const std::filesystem::path& file, Role role) {
  RecordingReader reader(file);
  for (RecordedFrame frame; reader.next(frame);)
    if (frame.role == role) frames_.push_back(std::move(frame));
}

void ReplayChannel::send(std::span<const std::span<const std::byte>> parts, Deadline) {
  if (at_ == frames_.size() || frames_[at_].direction != Direction::to_coordinator)
    throw Error(ErrorCode::protocol, "the participant speaks where it was silent in the recording", peer_);
  Bytes sent;
  for (const auto& part : parts) sent.insert(sent.end(), part.begin(), part.end());
  const Bytes& recorded = frames_[at_++].frame;
  if (!holds_results(open_frame(recorded, peer_).kind)) return;
  ++compared_;
  if (sent != recorded) ++different_;
}

bool ReplayChannel::wait(Deadline) {
  if (at_ == frames_.size()) throw Error(ErrorCode::peer_lost, "the recording ends here", peer_);
  return frames_[at_].direction == Direction::to_participant;
}

void ReplayChannel::receive(Bytes& frame, Deadline deadline) {
  if (!wait(deadline))
    throw Error(ErrorCode::protocol, "the participant is silent where it spoke in the recording", peer_);
  frame = frames_[at_++].frame;
}

}  // namespace tandem::protocol
