#include "launch/conform/raw_end.hpp"

#include <array>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "protocol/registration.hpp"

namespace tandem::conform {

using protocol::Kind;

RawEnd::RawEnd(Subject& subject, const JudgedScene& scene, const Limits& limits, bool configure)
    : instance_(subject.start({})), channel_(instance_->take_channel()), patience_(limits.patience) {
  const Answer greeting = receive();
  protocol::Hello hello;
  protocol::decode(greeting.payload(), hello);
  version_ = protocol::admit(hello, protocol::open_frame(greeting.frame, channel_->peer()).version,
                             subject.role(), 0, channel_->peer());
  run_id_ = 1;
  send(Kind::welcome, protocol::Bytes{});
  if (!configure) return;
  send(Kind::configure, scene.configuration);
  const Answer answer = receive();
  if (answer.kind == Kind::failure) {
    protocol::Failure failure;
    protocol::decode(answer.payload(), failure);
    const Error error(failure.code, failure.what, failure.where, failure.hint);
    if (error.code() == ErrorCode::scene) throw SceneRefused(error);
    throw error;
  }
  protocol::decode(answer.payload(), configured_);
}

void RawEnd::send(Kind kind, const protocol::Bytes& payload, std::uint64_t window) {
  protocol::FrameHeader header;
  header.version = version_;
  header.kind = kind;
  header.run_id = run_id_;
  header.window = window;
  header.sequence = ++sent_;
  protocol::seal(header, payload);
  const std::array<std::span<const std::byte>, 2> parts{std::as_bytes(std::span(&header, 1)), payload};
  channel_->send(parts, protocol::Clock::now() + patience_);
}

RawEnd::Answer RawEnd::receive() {
  Answer answer;
  channel_->receive(answer.frame, protocol::Clock::now() + patience_);
  answer.kind = protocol::open_frame(answer.frame, channel_->peer()).kind;
  return answer;
}

protocol::Failure RawEnd::refusal(const std::string& of) {
  const Answer answer = receive();
  if (answer.kind != Kind::failure)
    throw Error(ErrorCode::protocol,
                of + " was answered with " + std::string(protocol::name(answer.kind)) + ", not with failure");
  protocol::Failure failure;
  protocol::decode(answer.payload(), failure);
  return failure;
}

}  // namespace tandem::conform
