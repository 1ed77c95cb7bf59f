#include "protocol/link.hpp"

#include <array>

#include "common/utf8.hpp"
#include "protocol/recorder.hpp"

namespace tandem::protocol {

using namespace std::chrono_literals;

Link::Link(Channel& channel, Role role, Sender self, FrameSink* recorder)
    : channel_(channel), self_(self), recorder_(recorder), session_(role) {}

void Link::adopt(RunIdentity identity, Version version) {
  identity_ = identity;
  version_ = version;
  adopted_ = true;
}

void Link::send(Kind kind, Deadline deadline) {
  out_.clear();
  send_payload(kind, Clock::now(), deadline);
}

void Link::send_payload(Kind kind, Clock::time_point begin, Deadline deadline) {
  current_ = kind;
  ours_ = true;
  check([&] { session_.step(kind, self_); });
  FrameHeader header;
  header.version = version_;
  header.kind = kind;
  header.generation = identity_.generation;
  header.run_id = identity_.run_id;
  header.window = progress_.window();
  header.iteration = progress_.iteration();
  header.sequence = ++sent_;
  seal(header, out_);
  const auto head = std::as_bytes(std::span(&header, 1));
  if (recorder_)
    recorder_->record(self_ == Sender::coordinator ? Direction::to_participant : Direction::to_coordinator,
                      session_.role(), head, out_);
  const std::array<std::span<const std::byte>, 2> parts{head, out_};
  try {
    channel_.send(parts, deadline);
  } catch (const Error& e) {
    throw in_window(e, name(kind));
  }
  exchange_ += Clock::now() - begin;
}

Kind Link::receive(Deadline deadline, const char* awaited, const std::function<void()>& idle) {
  // Short waits, so that `idle` is called in between; a frame that has arrived costs one of them.
  constexpr auto slice = 50ms;
  const Clock::time_point begin = Clock::now();
  Clock::time_point arrived = begin;
  try {
    while (!channel_.wait(std::min(deadline, arrived + slice))) {
      arrived = Clock::now();
      if (idle) idle();
      if (arrived < deadline) continue;
      const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(arrived - begin).count();
      throw Error(ErrorCode::timeout, peer() + " gave no sign for " + std::to_string(waited) + " ms", {},
                  "where it only needs longer, give tandem run a larger --patience");
    }
    arrived = Clock::now();
    wait_ += arrived - begin;
    channel_.receive(in_, deadline);
  } catch (const Error& e) {
    throw in_window(e, awaited);
  }
  current_ = {};
  ours_ = false;
  header_ = open_frame(in_, peer());
  current_ = header_.kind;
  if (recorder_)
    recorder_->record(self_ == Sender::coordinator ? Direction::to_coordinator : Direction::to_participant,
                      session_.role(), std::span(in_).first(sizeof(FrameHeader)), payload_of(in_));
  check([&] { check_header(); });
  exchange_ += Clock::now() - arrived;
  if (header_.kind == Kind::failure) {
    Failure failure;
    read(failure);
    // Longer than any of our error texts, and short enough for a terminal.
    constexpr std::size_t longest = 2000;
    throw Error(failure.code, shortened(failure.what, longest), shortened(failure.where, longest),
                shortened(failure.hint, longest));
  }
  return header_.kind;
}

bool Link::pending() {
  try {
    return channel_.wait(Clock::now());
  } catch (const Error& e) {
    throw in_window(e, "its next message");
  }
}

void Link::check_header() {
  const auto fail = [](Violation violation, const std::string& field, std::uint64_t value,
                       std::uint64_t expected, const std::string& hint = {}) {
    throw ProtocolError(violation,
                        field + " is " + std::to_string(value) + ", expected " + std::to_string(expected), {},
                        hint);
  };
  if (header_.sequence != received_ + 1)
    fail(Violation::wrong_sequence, "sequence", header_.sequence, received_ + 1,
         "a frame was lost or repeated");
  received_ = header_.sequence;
  // A participant that failed before it received the welcome does not know the run; the failure is then its
  // second message, after hello.
  const bool before_welcome = header_.kind == Kind::failure && received_ == 2 && header_.run_id == 0;
  if (adopted_ && !before_welcome) {
    if (header_.run_id != identity_.run_id)
      fail(Violation::wrong_run, "run id", header_.run_id, identity_.run_id,
           "the peer belongs to another run");
    if (header_.generation != identity_.generation)
      fail(Violation::wrong_generation, "generation", header_.generation, identity_.generation,
           "the peer belongs to an earlier start of this run");
    if (header_.version != version_)
      fail(Violation::wrong_version, "minor version", header_.version.minor, version_.minor);
  }
  session_.step(header_.kind, self_ == Sender::coordinator ? Sender::participant : Sender::coordinator);
  if (header_.kind == Kind::failure) return;  // allowed in any window
  if (header_.window != progress_.window())
    fail(Violation::wrong_window, "the header's window", header_.window, progress_.window());
  if (header_.iteration != progress_.iteration())
    fail(Violation::wrong_iteration, "the header's iteration", header_.iteration, progress_.iteration());
}

Error Link::in_window(const Error& e, const char* awaited) const {
  if (e.code() != ErrorCode::peer_lost && e.code() != ErrorCode::timeout) return e;
  return Error(e.code(),
               e.problem() + " in window " + std::to_string(progress_.window()) + ", before " + awaited,
               e.where(), e.hint());
}

ProtocolError Link::located(const ProtocolError& e) const {
  if (!e.where().empty()) return e;
  return ProtocolError(e.violation(), e.problem(), place(), e.hint());
}

std::string Link::place() const {
  std::string where = "from " + peer();
  if (ours_)
    where = self_ == Sender::coordinator ? "to " + peer() : "from " + std::string(name(session_.role()));
  if (current_ != Kind{})
    where = std::string(name(current_)) + " of window " + std::to_string(progress_.window()) + " " + where;
  return where;
}

}  // namespace tandem::protocol
