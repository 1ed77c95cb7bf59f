// A participant's end of a channel that spoils the conversation: for tests of the judge.
#pragma once

#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/frame.hpp"

namespace tandem::test {

class SpoiltChannel final : public protocol::Channel {
 public:
  explicit SpoiltChannel(std::unique_ptr<protocol::Channel> inner) : inner_(std::move(inner)) {}

  // Changes a frame that has arrived, before the participant sees it.
  std::function<void(std::vector<std::byte>& frame)> arrived;
  // Whether a frame of the participant is sent.
  std::function<bool(const protocol::FrameHeader& header)> passes;

  void send(std::span<const std::span<const std::byte>> parts, protocol::Deadline deadline) override {
    protocol::FrameHeader header;
    std::memcpy(&header, parts[0].data(), sizeof header);
    if (!passes || passes(header)) inner_->send(parts, deadline);
  }
  bool wait(protocol::Deadline deadline) override { return inner_->wait(deadline); }
  void receive(std::vector<std::byte>& frame, protocol::Deadline deadline) override {
    inner_->receive(frame, deadline);
    if (arrived) arrived(frame);
  }
  bool peer_gone() noexcept override { return inner_->peer_gone(); }
  const char* transport() const override { return inner_->transport(); }
  const std::string& peer() const override { return inner_->peer(); }

 private:
  std::unique_ptr<protocol::Channel> inner_;
};

}  // namespace tandem::test
