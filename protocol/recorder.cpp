#include "protocol/recorder.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "protocol/frame.hpp"
#include "protocol/layout.hpp"
#include "protocol/registration.hpp"

namespace tandem::protocol {
namespace {

struct Head {
  char magic[8];
  std::uint64_t layout = 0;
};
struct RecordHead {
  std::int64_t time = 0;
  std::uint32_t direction = 0, role = 0;
  std::uint64_t size = 0;
};
static_assert(sizeof(Head) == 16 && sizeof(RecordHead) == 24 && sizeof(MissingFrames) == 24);

constexpr std::uint64_t largest_recording = std::numeric_limits<std::int64_t>::max();  // read frame by frame
constexpr char magic[8] = {'T', 'N', 'D', 'M', 'R', 'E', 'C', '2'};
constexpr char first_magic[8] = {'T', 'N', 'D', 'M', 'R', 'E', 'C', '1'};
constexpr std::uint32_t missing_frames = 2;  // in place of a direction
constexpr const char* how_to_record = "give a file made by tandem run --record, or last_windows.rec of a run";

bool is_magic(const char* begin) {
  return std::memcmp(begin, magic, sizeof magic) == 0 || std::memcmp(begin, first_magic, sizeof magic) == 0;
}

template <class T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
bool get(std::istream& in, T& value) {
  return static_cast<bool>(in.read(reinterpret_cast<char*>(&value), sizeof value));
}

const std::filesystem::path& replaceable(const std::filesystem::path& file) {
  Recorder::expect_replaceable(file);
  return file;
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
  if (there.gcount() > 0 && !is_magic(begin))
    throw Error(ErrorCode::usage, "is there, and is no recording: it would be overwritten", file.string(),
                hint);
}

RecordingWriter::RecordingWriter(const std::filesystem::path& file)
    : path_(file), file_(file, std::ios::binary) {
  Head head{};
  std::memcpy(head.magic, magic, sizeof magic);
  head.layout = layout_hash;
  put(file_, head);
  if (!file_)
    throw Error(ErrorCode::resource, "cannot be written", path_.string(),
                "check folder, permissions and space");
}

void RecordingWriter::write(std::int64_t time, Direction direction, Role role,
                            std::span<const std::span<const std::byte>> parts) {
  std::uint64_t size = 0;
  for (const auto& part : parts) size += part.size();
  put(file_, RecordHead{time, static_cast<std::uint32_t>(direction), static_cast<std::uint32_t>(role), size});
  for (const auto& part : parts)
    file_.write(reinterpret_cast<const char*>(part.data()), static_cast<std::streamsize>(part.size()));
  expect_good();
}

void RecordingWriter::write(const MissingFrames& missing) {
  put(file_, RecordHead{0, missing_frames, 0, sizeof missing});
  put(file_, missing);
  expect_good();
}

void RecordingWriter::close() {
  file_.close();
  expect_good();
}

void RecordingWriter::expect_good() {
  if (!file_)
    throw Error(ErrorCode::resource, "the recording cannot be written any more", path_.string(),
                "free some space, or run without recording");
}

Recorder::Recorder(const std::filesystem::path& file) : writer_(replaceable(file)) {}

void Recorder::record(Direction direction, Role role, std::span<const std::byte> header,
                      std::span<const std::byte> payload) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (!start_) start_ = now;
  const auto time = std::chrono::duration_cast<std::chrono::nanoseconds>(now - *start_).count();
  const std::array<std::span<const std::byte>, 2> parts{header, payload};
  writer_.write(time, direction, role, parts);
}

RecordingReader::RecordingReader(const std::filesystem::path& file, Part part) : path_(file), part_(part) {
  expect_input(file, {.code = ErrorCode::usage, .largest = largest_recording, .hint = how_to_record});
  file_.open(file, std::ios::binary);
  Head head{};
  if (!get(file_, head) || !is_magic(head.magic))
    throw Error(ErrorCode::usage, "is no recording", path_.string(), how_to_record);
  if (std::ranges::find(dialects, head.layout, &Dialect::layout_hash) == std::end(dialects))
    throw Error(ErrorCode::usage,
                "was recorded with another layout of the protocol than those of versions " + versions_of(),
                path_.string(), "read it with the release that recorded it");
  size_ = std::filesystem::file_size(path_);
  at_ = sizeof head;
}

void RecordingReader::fail(const std::string& problem) const {
  throw Error(ErrorCode::usage, "is damaged: record " + std::to_string(records_) + " " + problem,
              path_.string(), "take another copy of it, or record the run again");
}

bool RecordingReader::next(RecordedFrame& frame) {
  RecordHead head;
  if (!get(file_, head)) {
    not_read_ = size_ - std::min(at_, size_);
    return false;
  }
  ++records_;
  at_ += sizeof head;
  if (head.size > max_payload + sizeof(FrameHeader))
    fail("has a frame of " + std::to_string(head.size) + " bytes");
  if (head.direction > missing_frames) fail("has direction " + std::to_string(head.direction));
  // The record is truncated; memory is not allocated for the size that it announces.
  if (head.size > size_ - std::min(at_, size_)) {
    not_read_ = size_ - (at_ - sizeof head);
    return false;
  }
  at_ += head.size;
  frame.missing.reset();
  if (head.direction == missing_frames) {
    if (head.size != sizeof(MissingFrames)) fail("is no list of missing frames");
    frame = {};
    return get(file_, frame.missing.emplace());
  }
  if (head.size < sizeof(FrameHeader)) fail("is shorter than the header of a frame");
  frame.time = head.time;
  frame.direction = static_cast<Direction>(head.direction);
  frame.role = static_cast<Role>(head.role);
  frame.frame.resize(part_ == Part::headers ? sizeof(FrameHeader) : head.size);
  if (!file_.read(reinterpret_cast<char*>(frame.frame.data()),
                  static_cast<std::streamsize>(frame.frame.size())))
    return false;
  if (part_ == Part::headers) file_.seekg(static_cast<std::streamoff>(at_));
  std::memcpy(&frame.header, frame.frame.data(), sizeof frame.header);
  frame.has_payload = head.size == sizeof(FrameHeader) + frame.header.payload_size;
  if (!frame.has_payload && head.size != sizeof(FrameHeader))
    fail("has " + std::to_string(head.size - sizeof(FrameHeader)) + " bytes of a payload of " +
         std::to_string(frame.header.payload_size));
  return true;
}

}  // namespace tandem::protocol
