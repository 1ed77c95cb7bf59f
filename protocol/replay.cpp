#include "protocol/replay.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "common/utf8.hpp"
#include "protocol/codec.hpp"
#include "protocol/difference.hpp"
#include "protocol/registration.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

constexpr const char* whole_run = "record the whole run: tandem run --record FILE";

std::uint64_t capability_of(Kind order) {
  switch (order) {
    case Kind::predict:
      return can_predict;
    case Kind::save:
    case Kind::restore:
      return can_rollback;
    case Kind::extrapolate:
      return can_extrapolate;
    case Kind::control:
      return can_control;
    case Kind::resume:
      return can_checkpoint;
    default:
      return 0;
  }
}

std::string message_text(Kind kind, std::uint64_t window) {
  return std::string(name(kind)) + " of window " + std::to_string(window);
}

std::string failure_text(std::span<const std::byte> payload) {
  constexpr std::size_t longest = 2000;
  Failure failure;
  decode(payload, failure);
  return printable(shortened(Error(failure.code, failure.what, failure.where, failure.hint).what(), longest));
}

std::string plural(std::uint64_t n, const char* noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

// One pass through the frames of a role, with a participant at the other end.
class Player {
 public:
  Player(Channel& channel, const std::filesystem::path& file, Role role, std::uint64_t needed,
         std::chrono::milliseconds patience)
      : channel_(channel), reader_(file), file_(file), role_(role), needed_(needed), patience_(patience) {}

  ReplayResult run() {
    while (!over_ && next()) {
      if (recorded_.direction == Direction::to_participant)
        order();
      else
        answer();
    }
    if (!over_) end("the recording ends here");
    return std::move(result_);
  }

 private:
  bool next() {
    while (reader_.next(recorded_)) {
      if (recorded_.missing || recorded_.role != role_) continue;
      if (recorded_.has_payload) try {
          open_frame(recorded_.frame, file_.string());
        } catch (const ProtocolError& e) {
          throw Error(ErrorCode::usage, "is damaged: " + e.problem(), file_.string(),
                      "take another copy of it, or record the run again");
        }
      return true;
    }
    return false;
  }

  void order() {
    const Kind kind = recorded_.header.kind;
    // None of these changes the state, so that the rest can be compared without.
    const bool cannot = !can_answer(kind);
    if (kind == Kind::checkpoint || cannot) {
      ++(cannot ? result_.not_possible : result_.not_repeated);
      skipped_ = true;
      return;
    }
    if (kind == Kind::failure || kind == Kind::refuse) return end(failure_text(payload_of(recorded_.frame)));
    ordered_ = kind == Kind::welcome ? Kind{} : kind;
    ordered_window_ = recorded_.header.window;
    send(recorded_.header, payload_of(recorded_.frame));
  }

  bool can_answer(Kind kind) {
    if (kind == Kind::linearise) return (capabilities_ & can_linearise) != 0;
    if ((capabilities_ & can_snapshot) != 0 || (kind != Kind::snapshot && kind != Kind::observe)) return true;
    Nanoseconds time;
    decode(payload_of(recorded_.frame), time);
    if (kind == Kind::observe) return time != missed_snapshot_;
    missed_snapshot_ = time;
    return false;
  }

  void send(FrameHeader header, std::span<const std::byte> payload) {
    header.version = version_;
    header.run_id = run_id;
    header.generation = 0;
    header.sequence = ++sent_;
    seal(header, payload);
    const std::array<std::span<const std::byte>, 2> parts{std::as_bytes(std::span(&header, 1)), payload};
    try {
      channel_.send(parts, Clock::now() + patience_);
    } catch (const Error& e) {
      differ(std::string(name(role_)) + " did not take " + message_text(header.kind, header.window) + ": " +
             e.what());
    }
  }

  // Returns false where nothing came, with the sentence in `problem_`.
  bool receive() {
    try {
      const Deadline deadline = Clock::now() + patience_;
      if (!channel_.wait(deadline))
        throw Error(ErrorCode::timeout,
                    channel_.peer() + " gave no sign for " + std::to_string(patience_.count()) + " ms", {},
                    "where it only needs longer, give a larger --patience");
      channel_.receive(in_, deadline);
      header_ = open_frame(in_, channel_.peer());
      ++received_;
    } catch (const Error& e) {
      problem_ = e.what();
      return false;
    }
    return true;
  }

  void answer() {
    const FrameHeader& recorded = recorded_.header;
    if (std::exchange(skipped_, false) && recorded.kind != Kind::failure) return;
    const std::string awaited = message_text(recorded.kind, recorded.window);
    if (!receive()) return differ("instead of " + awaited + " there is no answer: " + problem_);
    if (recorded.kind == Kind::hello) return admit_peer();
    ordered_ = {};
    if (header_.kind != recorded.kind) {
      const std::string instead = header_.kind == Kind::failure
                                      ? "it failed: " + failure_text(payload_of(in_))
                                      : "it answered " + message_text(header_.kind, header_.window);
      return differ(
          "instead of " + awaited +
          (recorded.kind == Kind::failure ? " (" + failure_text(payload_of(recorded_.frame)) + ") " : " ") +
          instead);
    }
    if (const auto problem = problem_of_header()) return differ(awaited + ": " + *problem);
    compare(awaited);
    if (recorded.kind == Kind::report || recorded.kind == Kind::failure) over_ = true;
    if (recorded.kind == Kind::failure && !result_.difference)
      result_.ending = "both fail: " + failure_text(payload_of(in_));
  }

  void admit_peer() {
    try {
      Hello hello;
      if (header_.kind != Kind::hello)
        throw ProtocolError(Violation::not_allowed, std::string("the first message is ") + name(header_.kind),
                            channel_.peer(), "a participant begins with hello");
      decode(payload_of(in_), hello);
      capabilities_ = hello.capabilities;
      version_ = admit(hello, header_.version, role_, needed_, channel_.peer());
    } catch (const ProtocolError& e) {
      Bytes payload;
      encode(payload, Failure{e.code(), e.problem(), e.where(), e.hint()});
      FrameHeader header;
      header.kind = Kind::refuse;
      send(header, payload);
      throw;
    }
  }

  std::optional<std::string> problem_of_header() const {
    const auto differs = [](const char* field, std::uint64_t here, std::uint64_t expected) {
      return std::string("the header's ") + field + " is " + std::to_string(here) + ", expected " +
             std::to_string(expected);
    };
    if (header_.sequence != received_) return differs("sequence", header_.sequence, received_);
    if (header_.version != version_) return differs("minor version", header_.version.minor, version_.minor);
    if (header_.kind == Kind::failure) return {};  // allowed in any window, also before the welcome
    if (header_.run_id != run_id) return differs("run id", header_.run_id, run_id);
    if (header_.generation != 0) return differs("generation", header_.generation, 0);
    if (header_.window != recorded_.header.window)
      return differs("window", header_.window, recorded_.header.window);
    if (header_.iteration != recorded_.header.iteration)
      return differs("iteration", header_.iteration, recorded_.header.iteration);
    return {};
  }

  void compare(const std::string& awaited) {
    const Kind kind = recorded_.header.kind;
    if (kind == Kind::done || kind == Kind::report) return;
    if (!recorded_.has_payload) {
      ++result_.not_kept;
      return;
    }
    std::optional<Difference> found;
    try {
      found = first_difference(kind, payload_of(in_), payload_of(recorded_.frame));
    } catch (const ProtocolError& e) {
      return differ(awaited + ": its payload cannot be read: " + e.problem());
    }
    if (!found) {
      ++result_.compared;
      if (kind == Kind::motion || kind == Kind::load)
        result_.windows = std::max(result_.windows, recorded_.header.window + 1);
      return;
    }
    differ(awaited + ", " + found->place + ": replayed " + printable(found->replayed) + ", recorded " +
           printable(found->recorded) +
           (found->difference.empty() ? "" : ", difference " + found->difference));
  }

  void differ(const std::string& sentence) {
    if (!result_.difference) result_.difference = sentence;
    leave();
  }

  // The recording ends before the report, for this reason.
  void end(const std::string& reason) {
    result_.ending = reason;
    if (ordered_ != Kind{}) {
      result_.ending =
          "there is no answer to " + message_text(ordered_, ordered_window_) + " in the recording: " + reason;
      if (receive())
        *result_.ending += header_.kind == Kind::failure
                               ? "; here it fails: " + failure_text(payload_of(in_))
                               : std::string("; here it answers ") + name(header_.kind);
      else
        *result_.ending += "; here as well: " + problem_;
    }
    leave();
  }

  // So that the participant leaves at once.
  void leave() {
    over_ = true;
    Bytes payload;
    encode(payload, Failure{ErrorCode::interrupted, "the replay ends here", {}, {}});
    FrameHeader header;
    header.kind = Kind::failure;
    header.version = version_;
    header.run_id = run_id;
    header.sequence = ++sent_;
    seal(header, payload);
    const std::array<std::span<const std::byte>, 2> parts{std::as_bytes(std::span(&header, 1)),
                                                          std::span<const std::byte>(payload)};
    try {
      channel_.send(parts, Clock::now() + std::chrono::milliseconds(200));
    } catch (const Error&) {  // it has left already
    }
  }

  static constexpr std::uint64_t run_id = 1;  // the run has two ends, which one process has started

  Channel& channel_;
  RecordingReader reader_;
  std::filesystem::path file_;
  Role role_;
  std::uint64_t needed_;
  std::chrono::milliseconds patience_;
  RecordedFrame recorded_;
  Bytes in_;
  FrameHeader header_;  // of in_
  std::string problem_;
  Version version_ = protocol_version;
  std::uint64_t capabilities_ = 0;
  std::uint64_t sent_ = 0, received_ = 0;
  Kind ordered_{};  // without an answer so far
  std::uint64_t ordered_window_ = 0;
  std::optional<Nanoseconds> missed_snapshot_;  // that the participant cannot take
  bool skipped_ = false;                        // the last order
  bool over_ = false;
  ReplayResult result_;
};

}  // namespace

Replay::Replay(const std::filesystem::path& file, Role role) : file_(file), role_(role) {
  RecordingReader reader(file);
  std::size_t frames = 0;
  std::optional<MissingFrames> missing;
  for (RecordedFrame frame; reader.next(frame);) {
    if (frame.missing) missing = frame.missing;
    if (frame.missing || frame.role != role) continue;
    ++frames;
    const Kind kind = frame.header.kind;
    if (frame.direction == Direction::to_coordinator) continue;
    if (!frame.has_payload)
      throw Error(ErrorCode::usage,
                  "the payload of " + message_text(kind, frame.header.window) + " (" +
                      plural(frame.header.payload_size, "byte") + ") was too large to be kept",
                  file.string(), whole_run);
    needed_ |= capability_of(kind);
    if (kind == Kind::resume) {
      Checkpoint from;
      try {
        decode(payload_of(frame.frame), from);
      } catch (const ProtocolError& e) {
        throw Error(ErrorCode::usage, "is damaged: " + e.problem(), file.string());
      }
      state_folder_ = std::filesystem::path(from.path).parent_path();
    }
  }
  not_read_ = reader.not_read();
  if (frames == 0)
    throw Error(ErrorCode::usage, std::string("has no frames of ") + name(role), file.string(),
                "give the other --role");
  if (missing)
    throw Error(
        ErrorCode::usage,
        "windows " + std::to_string(missing->first_window) + " to " + std::to_string(missing->last_window) +
            " are missing, from which the participant would come to the state of the next one",
        file.string(), std::string("for a replay to the bit ") + whole_run + "; --list shows what is there");
}

ReplayResult Replay::against(Channel& channel, std::chrono::milliseconds patience) const {
  return Player(channel, file_, role_, needed_, patience).run();
}

}  // namespace tandem::protocol
