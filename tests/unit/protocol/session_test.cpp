// Every cell of the session's table, in the table itself and at both ends in operation: each message in each
// state is accepted, or refused with the reason of the table.
#include "protocol/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <thread>

#include "protocol/codec.hpp"
#include "protocol/frame.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/registration.hpp"
#include "protocol/remote.hpp"
#include "protocol/violation.hpp"
#include "toy_solvers.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr std::array roles{Role::mbd, Role::dem};
constexpr auto unknown = static_cast<Kind>(77);

// ---- the table

TEST(SessionTable, EveryStateIsReachedAndLeft) {
  for (const Role role : roles) {
    std::set<SessionState> reached{SessionState::connected};
    for (std::size_t before = 0; before != reached.size();) {
      before = reached.size();
      for (const SessionState state : std::set(reached))
        for (const Kind kind : all_kinds)
          for (const Sender sender : {Sender::coordinator, Sender::participant})
            if (const Verdict v = verdict(role, state, kind, sender); v.refusal == Refusal::none)
              reached.insert(v.next);
    }
    const std::set<SessionState> others =
        role == Role::mbd ? std::set{SessionState::loading, SessionState::copying}
                          : std::set{SessionState::predicting, SessionState::extrapolating,
                                     SessionState::controlling, SessionState::moving};
    for (const SessionState state : all_states)
      EXPECT_EQ(reached.contains(state), !others.contains(state)) << name(role) << " " << name(state);
  }
}

TEST(SessionTable, EachCellIsTakenOrHasItsReason) {
  std::set<Refusal> given;
  for (const Role role : roles)
    for (const SessionState state : all_states)
      for (const Kind kind : all_kinds)
        for (const Sender sender : {Sender::coordinator, Sender::participant}) {
          const Verdict v = verdict(role, state, kind, sender);
          given.insert(v.refusal);
          if (v.refusal != Refusal::none) {
            EXPECT_EQ(v.next, state);
          } else if (kind != Kind::failure) {
            EXPECT_EQ(sender_of(kind), sender);
            EXPECT_NE(v.next, state);
          }
          if (state == SessionState::ended) {
            EXPECT_EQ(v.refusal, Refusal::after_end);
          } else if (kind == Kind::failure) {
            EXPECT_EQ(v.next, SessionState::ended);
          } else if (sender_of(kind) != sender) {
            EXPECT_EQ(v.refusal, Refusal::wrong_sender);
          }
        }
  EXPECT_EQ(verdict(Role::mbd, SessionState::ready, unknown, Sender::coordinator).refusal,
            Refusal::unknown_message);
  given.insert(Refusal::unknown_message);
  for (int i = 0; i <= static_cast<int>(Refusal::after_end); ++i)
    EXPECT_TRUE(given.contains(static_cast<Refusal>(i)))
        << name(static_cast<Refusal>(i)) << " is never given";
}

TEST(SessionTable, OneSideSpeaksAtATime) {
  // No state allows both sides to send (except failure): the two ends cannot disagree about the order of
  // messages.
  for (const Role role : roles)
    for (const SessionState state : all_states) {
      std::set<Sender> speakers;
      for (const Kind kind : all_kinds)
        for (const Sender sender : {Sender::coordinator, Sender::participant})
          if (kind != Kind::failure && verdict(role, state, kind, sender).refusal == Refusal::none)
            speakers.insert(sender);
      EXPECT_LE(speakers.size(), 1u) << name(role) << " " << name(state);
    }
}

TEST(SessionTable, ARefusedStepLeavesTheStateAndSaysWhatIsAllowed) {
  Session session(Role::mbd);
  try {
    session.step(Kind::predict, Sender::coordinator);
    FAIL();
  } catch (const ProtocolError& e) {
    EXPECT_EQ(e.violation(), Violation::not_allowed);
    EXPECT_STREQ(e.what(),
                 "predict from the coordinator in state connected: the participant is not registered yet "
                 "(allowed: hello, failure)");
  }
  EXPECT_EQ(session.state(), SessionState::connected);
}

// ---- the ends in operation

constexpr RunIdentity identity{42, 1};

// A valid payload for each message.
Bytes payload(Kind kind, Role role) {
  Bytes out;
  ToyMotion motion;
  ToyLoad load;
  const Window w = window(0);
  LoadSet no_loads;
  no_loads.window = w;
  switch (kind) {
    case Kind::hello:
      encode(out, Hello{role, layout_hash, capabilities_of(role), 1, "raw", "host"});
      break;
    case Kind::refuse:
    case Kind::failure:
      encode(out, Failure{ErrorCode::numerics, "diverged", "", ""});
      break;
    case Kind::configure:
      encode(out, Configuration{});
      break;
    case Kind::configured:
      encode(out, role == Role::mbd ? motion.configure({}) : load.configure({}));
      break;
    case Kind::predict:
    case Kind::extrapolate:
      encode(out, w);
      break;
    case Kind::control:
      encode(out, ControlSet{{0}, {1.5}});
      break;
    case Kind::checkpoint:
    case Kind::resume:
      encode(out, Checkpoint{0, {0}, "/tmp/state.h5"});
      break;
    case Kind::advance_mbd:
      encode(out, no_loads);
      break;
    case Kind::motion:
    case Kind::advance_dem:
      encode(out, motion.predict(w));
      break;
    case Kind::load:
      encode(out, load.advance(motion.predict(w)));
      break;
    case Kind::tangents:
      encode(out, load.linearise());
      break;
    case Kind::observe:
    case Kind::snapshot:
      encode(out, Nanoseconds{0});
      break;
    case Kind::bodies:
      encode(out, motion.observe());
      break;
    case Kind::particles:
      encode(out, load.observe());
      break;
    case Kind::report:
      encode(out, Report{"{}"});
      break;
    default:
      break;
  }
  return out;
}

// An end that sends any message on request, in valid frames.
class RawPeer {
 public:
  RawPeer(std::unique_ptr<Channel> channel, Role role) : channel_(std::move(channel)), role_(role) {}

  void send(Kind kind) { send(kind, payload(kind, role_)); }
  void send(Kind kind, const Bytes& body, FrameHeader header = {}) {
    header.kind = kind;
    if (header.sequence == 0) header.sequence = ++sent_;
    if (registered_ || kind == Kind::welcome) {
      if (header.run_id == 0) header.run_id = identity.run_id;
      if (header.generation == 0) header.generation = identity.generation;
    }
    if (kind == Kind::welcome) registered_ = true;
    seal(header, body);
    const std::array<std::span<const std::byte>, 2> parts{std::as_bytes(std::span(&header, 1)), body};
    channel_->send(parts, Clock::now() + 5s);
  }
  Kind receive() {
    channel_->receive(frame_, Clock::now() + 5s);
    const FrameHeader header = open_frame(frame_, "peer");
    if (header.run_id != 0) registered_ = true;
    return header.kind;
  }
  std::string failure() const {
    Failure f;
    decode(payload_of(frame_), f);
    return Error(f.code, f.what, f.where, f.hint).what();
  }

 private:
  std::unique_ptr<Channel> channel_;
  Role role_;
  Bytes frame_;
  std::uint64_t sent_ = 0;
  bool registered_ = false;
};

// A participant that serves in a thread, in a state in which it receives.
struct Served {
  Served(Role role, SessionState state) : peer(nullptr, role) {
    auto [coordinator, participant] = create_inproc(name(role));
    peer = RawPeer(std::move(coordinator), role);
    thread = std::jthread([this, role, end = std::move(participant)]() mutable {
      ToyMotion motion;
      ToyLoad load;
      status = role == Role::mbd ? serve(*end, motion, "toy") : serve(*end, load, "toy");
      end.reset();
    });
    EXPECT_EQ(peer.receive(), Kind::hello);
    if (state == SessionState::greeted) return;
    peer.send(Kind::welcome);
    if (state == SessionState::registered) return;
    peer.send(Kind::configure);
    EXPECT_EQ(peer.receive(), Kind::configured);
  }
  // Otherwise a participant that still receives would be waited for.
  ~Served() { peer = RawPeer(nullptr, Role::mbd); }
  RawPeer peer;
  int status = -1;
  std::jthread thread;
};

TEST(SessionCells, AParticipantTakesOrRefusesEachMessageInEachState) {
  std::vector<Kind> kinds(all_kinds.begin(), all_kinds.end());
  kinds.push_back(unknown);
  for (const Role role : roles)
    for (const SessionState state : {SessionState::greeted, SessionState::registered, SessionState::ready})
      for (const Kind kind : kinds) {
        SCOPED_TRACE(std::string(name(role)) + ", " + name(state) + ", " + name(kind));
        const Verdict v = verdict(role, state, kind, Sender::coordinator);
        Served served(role, state);
        served.peer.send(kind);
        if (v.refusal != Refusal::none) {
          ASSERT_EQ(served.peer.receive(), Kind::failure);
          EXPECT_THAT(served.peer.failure(), HasSubstr(sentence(v.refusal)));
          served.thread.join();
          EXPECT_EQ(served.status, exit_status(ErrorCode::protocol));
        } else if (kind == Kind::refuse || kind == Kind::failure) {
          served.thread.join();
          EXPECT_EQ(served.status,
                    exit_status(kind == Kind::refuse ? ErrorCode::protocol : ErrorCode::numerics));
        } else if (kind == Kind::restore) {
          // The table allows it; whether something was saved before is checked separately.
          ASSERT_EQ(served.peer.receive(), Kind::failure);
          EXPECT_THAT(served.peer.failure(), HasSubstr("before the first save"));
        } else if (kind == Kind::welcome) {
          served.peer.send(Kind::configure);
          EXPECT_EQ(served.peer.receive(), Kind::configured);
        } else {
          const Kind answer = served.peer.receive();
          EXPECT_EQ(verdict(role, v.next, answer, Sender::participant).refusal, Refusal::none)
              << name(answer);
          EXPECT_NE(answer, Kind::failure) << served.peer.failure();
        }
      }
}

// One of the coordinator's calls, and the session state that it needs.
struct Call {
  Role role;
  SessionState waits_in;
  Kind order;
  std::function<void(Remote&)> call;
};

void ready(Remote& remote, RawPeer& peer) {
  peer.send(Kind::hello);
  remote.register_peer(0, 5s);
  EXPECT_EQ(peer.receive(), Kind::welcome);
  peer.send(Kind::configured);
  remote.configure({});
  EXPECT_EQ(peer.receive(), Kind::configure);
}

TEST(SessionCells, TheCoordinatorTakesOrRefusesEachMessageInEachState) {
  const std::vector<Call> calls{
      {Role::mbd, SessionState::connected, Kind::hello, [](Remote& r) { r.register_peer(0, 5s); }},
      {Role::dem, SessionState::connected, Kind::hello, [](Remote& r) { r.register_peer(0, 5s); }},
      {Role::mbd, SessionState::predicting, Kind::predict,
       [](Remote& r) {
         r.start_predict(window(0));
         r.finish_motion();
       }},
      {Role::mbd, SessionState::moving, Kind::advance_mbd,
       [](Remote& r) {
         LoadSet loads;
         loads.window = window(0);
         r.start_advance(loads);
         r.finish_motion();
       }},
      {Role::dem, SessionState::loading, Kind::advance_dem,
       [](Remote& r) {
         ToyMotion toy;
         r.start_advance(toy.predict(window(0)));
         r.finish_load();
       }},
      {Role::mbd, SessionState::extrapolating, Kind::extrapolate,
       [](Remote& r) {
         r.start_extrapolate(window(0));
         r.finish_motion();
       }},
      {Role::mbd, SessionState::controlling, Kind::control,
       [](Remote& r) {
         r.control({{0}, {1.5}});
       }},
      {Role::dem, SessionState::linearising, Kind::linearise, [](Remote& r) { r.linearise(); }},
      {Role::mbd, SessionState::linearising, Kind::linearise, [](Remote& r) { r.linearise(); }},
      {Role::mbd, SessionState::saving, Kind::save, [](Remote& r) { r.save(); }},
      {Role::dem, SessionState::saving, Kind::save, [](Remote& r) { r.save(); }},
      {Role::mbd, SessionState::checkpointing, Kind::checkpoint,
       [](Remote& r) {
         r.checkpoint({0, {0}, "/tmp/state.h5"});
       }},
      {Role::dem, SessionState::resuming, Kind::resume,
       [](Remote& r) {
         r.resume({7, {7'000'000}, "/tmp/state.h5"});
       }},
      {Role::mbd, SessionState::observing, Kind::observe, [](Remote& r) { r.observe_bodies({0}); }},
      {Role::dem, SessionState::observing, Kind::observe, [](Remote& r) { r.observe_particles({0}); }},
      {Role::dem, SessionState::copying, Kind::snapshot, [](Remote& r) { r.snapshot({0}); }},
      {Role::mbd, SessionState::finishing, Kind::finish, [](Remote& r) { r.finish(); }},
      {Role::dem, SessionState::finishing, Kind::finish, [](Remote& r) { r.finish(); }},
  };
  std::vector<Kind> kinds(all_kinds.begin(), all_kinds.end());
  kinds.push_back(unknown);
  for (const Call& call : calls)
    for (const Kind kind : kinds) {
      SCOPED_TRACE(std::string(name(call.role)) + ", " + name(call.waits_in) + ", " + name(kind));
      auto [coordinator, participant] = create_inproc(name(call.role));
      Remote remote(std::move(coordinator), call.role, identity);
      RawPeer peer(std::move(participant), call.role);
      if (call.waits_in != SessionState::connected) ready(remote, peer);
      peer.send(kind);  // waits in the channel for the order that it answers
      const Verdict v = verdict(call.role, call.waits_in, kind, Sender::participant);
      try {
        call.call(remote);
        EXPECT_EQ(v.refusal, Refusal::none);
        EXPECT_NE(kind, Kind::failure);
      } catch (const ProtocolError& e) {
        EXPECT_EQ(e.violation(), Violation::not_allowed) << e.what();
        EXPECT_THAT(e.what(), HasSubstr(sentence(v.refusal)));
      } catch (const Error& e) {
        EXPECT_EQ(kind, Kind::failure) << e.what();
        EXPECT_EQ(e.code(), ErrorCode::numerics);
      }
    }
}

// ---- frames with wrong headers

TEST(SessionFrames, AParticipantRefusesAFrameThatIsNotTheNextOfThisRun) {
  struct Lie {
    std::string text;
    FrameHeader header;
  };
  FrameHeader repeated, skipped, run, generation, later, again, minor;
  repeated.sequence = 2;
  skipped.sequence = 4;
  run.sequence = generation.sequence = later.sequence = again.sequence = minor.sequence = 3;
  run.run_id = 41;
  generation.generation = 9;
  later.window = 1;
  again.iteration = 1;
  minor.version.minor = protocol_version.minor + 1;
  const std::vector<Lie> lies{{"sequence is 2, expected 3", repeated},
                              {"sequence is 4, expected 3", skipped},
                              {"run id is 41, expected 42", run},
                              {"generation is 9, expected 1", generation},
                              {"the header's window is 1, expected 0", later},
                              {"the header's iteration is 1, expected 0", again},
                              {"minor version is 6, expected 5", minor}};
  for (const Lie& lie : lies) {
    Served served(Role::dem, SessionState::ready);
    served.peer.send(Kind::save, {}, lie.header);
    ASSERT_EQ(served.peer.receive(), Kind::failure);
    EXPECT_THAT(served.peer.failure(), HasSubstr(lie.text));
    served.thread.join();
    EXPECT_EQ(served.status, exit_status(ErrorCode::protocol));
  }
}

TEST(SessionFrames, ADamagedPayloadIsNamed) {
  Served served(Role::mbd, SessionState::ready);
  served.peer.send(Kind::predict, Bytes(16));
  ASSERT_EQ(served.peer.receive(), Kind::failure);
  EXPECT_THAT(served.peer.failure(),
              HasSubstr("predict of window 0 from coordinator: the payload of 16 bytes ends 8 bytes"));
}

TEST(SessionFrames, AnOldMajorVersionIsRefusedAndTold) {
  auto [coordinator, participant] = create_inproc("mbd_server");
  Remote remote(std::move(coordinator), Role::mbd, identity);
  RawPeer peer(std::move(participant), Role::mbd);
  FrameHeader header;
  header.version.major = 2;
  peer.send(Kind::hello, payload(Kind::hello, Role::mbd), header);
  try {
    remote.register_peer(0, 5s);
    FAIL();
  } catch (const ProtocolError& e) {
    EXPECT_EQ(e.violation(), Violation::wrong_version);
  }
  EXPECT_EQ(peer.receive(), Kind::refuse);
  EXPECT_THAT(peer.failure(), HasSubstr("major version 2, this program 1"));
}

TEST(SessionFrames, AForeignMinorVersionIsRefusedAndTold) {
  auto [coordinator, participant] = create_inproc("mbd_server");
  Remote remote(std::move(coordinator), Role::mbd, identity);
  RawPeer peer(std::move(participant), Role::mbd);
  FrameHeader header;
  header.version.minor = 6;
  peer.send(Kind::hello, payload(Kind::hello, Role::mbd), header);
  EXPECT_THROW(remote.register_peer(0, 5s), ProtocolError);
  EXPECT_EQ(peer.receive(), Kind::refuse);
  EXPECT_THAT(peer.failure(), HasSubstr("version is 1.6, the coordinator speaks 1.5, 1.4 and 1.3"));
}

}  // namespace
}  // namespace tandem::protocol::test
