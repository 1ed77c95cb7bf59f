// One end of a session: frames in and out, each checked against the session's table, its sequence number, the
// run's identity, and the window that both ends count by themselves. `serve` and `Remote` are built on it.
#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "protocol/channel.hpp"
#include "protocol/codec.hpp"
#include "protocol/frame.hpp"
#include "protocol/progress.hpp"
#include "protocol/run_identity.hpp"
#include "protocol/session.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol {

class FrameSink;  // recorder.hpp

class Link {
 public:
  Link(Channel& channel, Role role, Sender self, FrameSink* recorder = nullptr);

  // Sends a message without a payload, or with this value as payload.
  void send(Kind kind, Deadline deadline);
  template <class T>
  void send(Kind kind, const T& value, Deadline deadline) {
    const Clock::time_point begin = Clock::now();
    encode(out_, value);
    send_payload(kind, begin, deadline);
  }

  // The same for a payload that was encoded before; its memory is exchanged.
  void send_encoded(Kind kind, Bytes& payload, Deadline deadline) {
    std::swap(out_, payload);
    send_payload(kind, Clock::now(), deadline);
  }

  // Waits for the next message. `awaited` describes it for a time-out error: "the answer to advance_dem". A
  // failure message is thrown as the Error that the peer threw.
  Kind receive(Deadline deadline, const char* awaited, const std::function<void()>& idle = {});
  // Whether a message has arrived already.
  bool pending();
  // The payload of that message.
  template <class T>
  void read(T& value) {
    const Clock::time_point begin = Clock::now();
    check([&] { decode(payload_of(in_), value); });
    exchange_ += Clock::now() - begin;
  }
  // Exchanges the memory of that message for `frame`, whose payload may then be decoded by another thread.
  void take(Bytes& frame) { std::swap(in_, frame); }
  void read_nothing() {
    check([&] { decode_nothing(payload_of(in_)); });
  }

  // Runs a check of the present message; adds the sender, the message and the window to its error.
  template <class F>
  void check(F&& f) const {
    try {
      f();
    } catch (const ProtocolError& e) {
      throw located(e);
    }
  }

  // The same for a message that this end is about to send.
  template <class F>
  void vouch(Kind kind, F&& f) {
    current_ = kind;
    ours_ = true;
    check(f);
  }

  // The present message, its window and its sender, as in errors.
  std::string place() const;

  // Sets the values that the partners of the session agree on in welcome.
  void adopt(RunIdentity identity, Version version);
  // Header of the frame received last.
  const FrameHeader& header() const { return header_; }

  Session& session() { return session_; }
  Progress& progress() { return progress_; }
  const std::string& peer() const { return channel_.peer(); }
  Channel& channel() { return channel_; }
  Clock::duration waited() const { return wait_; }
  Clock::duration exchanged() const { return exchange_; }

 private:
  void send_payload(Kind kind, Clock::time_point begin, Deadline deadline);
  void check_header();
  Error in_window(const Error& e, const char* awaited) const;
  ProtocolError located(const ProtocolError& e) const;

  Channel& channel_;
  Sender self_;
  FrameSink* recorder_;
  Session session_;
  Progress progress_;
  RunIdentity identity_;
  Version version_ = protocol_version;
  bool adopted_ = false;
  std::uint64_t sent_ = 0, received_ = 0;  // sequence numbers of the last frames
  Kind current_{};                         // present message, for errors
  bool ours_ = false;                      // whether this end sent it
  Bytes out_, in_;                         // payload out, frame in
  FrameHeader header_;
  Clock::duration wait_{}, exchange_{};
};

}  // namespace tandem::protocol
