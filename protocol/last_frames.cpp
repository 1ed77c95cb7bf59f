#include "protocol/last_frames.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace tandem::protocol {

LastFrames::LastFrames(std::size_t bytes)
    : half_(std::bit_floor(bytes) / 2),
      largest_payload_(half_ / 8),
      ring_(std::make_unique_for_overwrite<std::byte[]>(half_)) {}

bool LastFrames::belongs_to_the_beginning(Kind kind) {
  switch (kind) {
    case Kind::hello:
    case Kind::welcome:
    case Kind::refuse:
    case Kind::configure:
    case Kind::configured:
      return true;
    default:
      return false;
  }
}

void LastFrames::put(const void* data, std::size_t size) {
  if (size == 0) return;  // a payload that is not there has no address
  const std::size_t at = end_ & (half_ - 1), first = std::min(size, half_ - at);
  const auto* bytes = static_cast<const std::byte*>(data);
  std::memcpy(ring_.get() + at, bytes, first);
  if (first < size) std::memcpy(ring_.get(), bytes + first, size - first);
  end_ += size;
}

void LastFrames::get(std::uint64_t from, void* data, std::size_t size) const {
  if (size == 0) return;
  const std::size_t at = from & (half_ - 1), first = std::min(size, half_ - at);
  auto* bytes = static_cast<std::byte*>(data);
  std::memcpy(bytes, ring_.get() + at, first);
  if (first < size) std::memcpy(bytes + first, ring_.get(), size - first);
}

LastFrames::Entry LastFrames::front() const {
  Entry entry;
  get(begin_, &entry, sizeof entry);
  return entry;
}

void LastFrames::drop_front() {
  const Entry entry = front();
  begin_ += sizeof entry + entry.size;
  if (missing_.frames++ == 0) missing_.first_window = entry.window;
  missing_.last_window = entry.window;
}

void LastFrames::record(Direction direction, Role role, std::span<const std::byte> header,
                        std::span<const std::byte> payload) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (!start_) start_ = now;
  FrameHeader read;
  std::memcpy(&read, header.data(), sizeof read);
  const auto entry_of = [&](std::size_t size) {
    return Entry{std::chrono::duration_cast<std::chrono::nanoseconds>(now - *start_).count(), direction, role,
                 read.window, size};
  };

  if (belongs_to_the_beginning(read.kind)) {
    const std::size_t left = half_ - beginning_.size(), least = sizeof(Entry) + header.size();
    if (least > left) {
      if (missing_.frames++ == 0) missing_.first_window = missing_.last_window = read.window;
      return;
    }
    if (payload.size() > left - least) payload = {};
    const Entry entry = entry_of(header.size() + payload.size());
    for (const auto& bytes : {std::as_bytes(std::span(&entry, 1)), header, payload})
      beginning_.insert(beginning_.end(), bytes.begin(), bytes.end());
    return;
  }

  if (payload.size() > largest_payload_) payload = {};
  const Entry entry = entry_of(header.size() + payload.size());
  while (end_ - begin_ + sizeof entry + entry.size > half_) {
    // A window goes as a whole, so that the first one that is left is complete.
    const std::uint64_t window = front().window;
    while (begin_ < end_ && front().window == window) drop_front();
  }
  put(&entry, sizeof entry);
  put(header.data(), header.size());
  put(payload.data(), payload.size());
}

bool LastFrames::empty() const {
  const std::lock_guard lock(mutex_);
  return beginning_.empty() && end_ == 0;
}

std::size_t LastFrames::size() const {
  const std::lock_guard lock(mutex_);
  return beginning_.size() + static_cast<std::size_t>(end_ - begin_);
}

void LastFrames::write(const std::filesystem::path& file) const {
  const std::lock_guard lock(mutex_);
  const std::filesystem::path draft = file.string() + ".new";
  try {
    RecordingWriter writer(draft);
    const auto write_one = [&](const Entry& entry, std::span<const std::byte> frame) {
      writer.write(entry.time, entry.direction, entry.role, std::span(&frame, 1));
    };
    for (std::size_t at = 0; at < beginning_.size();) {
      Entry entry;
      std::memcpy(&entry, beginning_.data() + at, sizeof entry);
      write_one(entry, std::span(beginning_).subspan(at + sizeof entry, entry.size));
      at += sizeof entry + entry.size;
    }
    if (missing_.frames > 0) writer.write(missing_);
    Bytes frame;
    for (std::uint64_t at = begin_; at < end_;) {
      Entry entry;
      get(at, &entry, sizeof entry);
      frame.resize(entry.size);
      get(at + sizeof entry, frame.data(), frame.size());
      write_one(entry, frame);
      at += sizeof entry + entry.size;
    }
    writer.close();
    std::filesystem::rename(draft, file);
  } catch (const std::exception& e) {
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    if (const auto* error = dynamic_cast<const Error*>(&e)) throw *error;
    throw Error(ErrorCode::resource, std::string("cannot be written: ") + e.what(), file.string(),
                "free some space");
  }
}

}  // namespace tandem::protocol
