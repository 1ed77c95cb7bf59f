// Sessions as inputs, and channels that replay and record their frames.
#pragma once

#include <cstring>
#include <optional>

#include "common/error.hpp"
#include "protocol/channel.hpp"
#include "protocol/codec.hpp"
#include "protocol/frame.hpp"
#include "tests/fuzz/files.hpp"

namespace tandem::fuzz {

// An input is one byte for the end under test, followed by the size and the bytes of each frame. With `early`
// added to that byte, frames arrive before they are requested.
inline constexpr unsigned to_mbd = 0, to_dem = 1, from_mbd = 2, from_dem = 3, early = 4, ends = 8;

using Script = std::vector<Bytes>;

inline Script frames_in(std::span<const std::byte> input) {
  Script frames;
  while (input.size() > sizeof(std::uint32_t)) {
    std::uint32_t size = 0;
    std::memcpy(&size, input.data(), sizeof size);
    input = input.subspan(sizeof size);
    const auto frame = input.first(std::min<std::size_t>(size, input.size()));
    frames.emplace_back(frame.begin(), frame.end());
    input = input.subspan(frame.size());
  }
  return frames;
}

inline Bytes input_of(unsigned end, const Script& frames) {
  Bytes all;
  for (const Bytes& frame : frames) {
    const auto size = static_cast<std::uint32_t>(frame.size());
    const auto head = std::as_bytes(std::span(&size, 1));
    all.insert(all.end(), head.begin(), head.end());
    all.insert(all.end(), frame.begin(), frame.end());
  }
  return choice(end, all);
}

// Replays the frames of a script, and keeps the failure that is sent.
class ScriptChannel : public protocol::Channel {
 public:
  ScriptChannel(Script frames, bool impatient) : frames_(std::move(frames)), early_(impatient) {}
  void send(std::span<const std::span<const std::byte>> parts, protocol::Deadline) override {
    protocol::FrameHeader header;
    std::memcpy(&header, parts[0].data(), sizeof header);
    if (header.kind != protocol::Kind::failure) return;
    protocol::Failure said;
    protocol::decode(parts[1], said);
    failure.emplace(said.code, said.what, said.where, said.hint);
  }
  bool wait(protocol::Deadline deadline) override {
    if (!early_ && deadline <= protocol::Clock::now()) return false;  // the caller only polls
    if (at_ == frames_.size()) throw Error(ErrorCode::peer_lost, "the script is over");
    return true;
  }
  void receive(std::vector<std::byte>& frame, protocol::Deadline deadline) override {
    wait(deadline);
    frame = frames_.at(at_++);
  }
  bool peer_gone() noexcept override { return at_ == frames_.size(); }
  const char* transport() const override { return "script"; }
  const std::string& peer() const override { return peer_; }

  std::optional<Error> failure;  // the failure that was sent, if any

 private:
  Script frames_;
  bool early_;
  std::size_t at_ = 0;
  std::string peer_ = "script";
};

// Records the frames that arrive.
class TappedChannel : public protocol::Channel {
 public:
  TappedChannel(std::unique_ptr<protocol::Channel> inner, Script& frames)
      : inner_(std::move(inner)), frames_(frames) {}
  void send(std::span<const std::span<const std::byte>> parts, protocol::Deadline deadline) override {
    inner_->send(parts, deadline);
  }
  bool wait(protocol::Deadline deadline) override { return inner_->wait(deadline); }
  void receive(std::vector<std::byte>& frame, protocol::Deadline deadline) override {
    inner_->receive(frame, deadline);
    frames_.push_back(frame);
  }
  bool peer_gone() noexcept override { return inner_->peer_gone(); }
  const char* transport() const override { return inner_->transport(); }
  const std::string& peer() const override { return inner_->peer(); }

 private:
  std::unique_ptr<protocol::Channel> inner_;
  Script& frames_;
};

}  // namespace tandem::fuzz
