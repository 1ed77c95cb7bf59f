// The coordinator's end without its own checks: it can send what a coordinator must not, to see that a
// participant refuses it.
#pragma once

#include <memory>
#include <optional>

#include "launch/conform/session.hpp"
#include "protocol/codec.hpp"
#include "protocol/frame.hpp"

namespace tandem::conform {

class RawEnd {
 public:
  // Registers the participant; with `configure` sends it the scene as well.
  RawEnd(Subject& subject, const JudgedScene& scene, const Limits& limits, bool configure);

  // `payload` as it is; `window` as the header's window.
  void send(protocol::Kind kind, const protocol::Bytes& payload, std::uint64_t window = 0);
  template <class T>
  void send(protocol::Kind kind, const T& value, std::uint64_t window = 0) {
    protocol::Bytes payload;
    protocol::encode(payload, value);
    send(kind, payload, window);
  }
  struct Answer {
    protocol::Kind kind{};
    protocol::Bytes frame;
    std::span<const std::byte> payload() const { return protocol::payload_of(frame); }
  };
  Answer receive();
  // The failure that answers; throws Error{protocol} with a sentence where another message comes, and the
  // channel's Error where none does.
  protocol::Failure refusal(const std::string& of);

  const protocol::Configured& configured() const { return configured_; }
  Instance& instance() { return *instance_; }

 private:
  std::unique_ptr<Instance> instance_;
  std::unique_ptr<protocol::Channel> channel_;
  protocol::Version version_ = protocol::protocol_version;
  std::chrono::milliseconds patience_;
  std::uint64_t sent_ = 0, run_id_ = 0;
  protocol::Configured configured_;
};

}  // namespace tandem::conform
