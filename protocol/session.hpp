// The order of messages between the coordinator and one participant, as one table (session.def) that both
// ends follow. The table of docs/protocol.md and the test of every cell are generated from it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/messages.hpp"

namespace tandem::protocol {

enum class SessionState : std::uint8_t {
  connected,    // the channel is up
  greeted,      // hello sent
  registered,   // welcome sent
  configuring,  // from here on the participant owes an answer in each state except ready
  ready,
  predicting,
  extrapolating,
  controlling,
  moving,
  loading,
  linearising,
  saving,
  restoring,
  checkpointing,
  resuming,
  observing,
  copying,
  finishing,
  ended,
};
inline constexpr std::array all_states{
    SessionState::connected,     SessionState::greeted,       SessionState::registered,
    SessionState::configuring,   SessionState::ready,         SessionState::predicting,
    SessionState::extrapolating, SessionState::controlling,   SessionState::moving,
    SessionState::loading,       SessionState::linearising,   SessionState::saving,
    SessionState::restoring,     SessionState::checkpointing, SessionState::resuming,
    SessionState::observing,     SessionState::copying,       SessionState::finishing,
    SessionState::ended};
inline constexpr std::array all_kinds{
#define MESSAGE(name, code, sender, meaning) Kind::name,
#include "protocol/messages.def"
#undef MESSAGE
};

enum class Sender : std::uint8_t { coordinator, participant, either };
Sender sender_of(Kind kind);
const char* meaning_of(Kind kind);

// Reason for refusing a message.
enum class Refusal : std::uint8_t {
  none,
  unknown_message,  // no such code
  wrong_sender,     // the other side's message
  wrong_role,       // a message for the other solver
  not_registered,   // before welcome
  not_configured,   // before configured
  repeated,         // registration or configuration a second time
  answer_owed,      // a new order before the answer to the last one
  wrong_answer,     // an answer to another order
  not_asked,        // an answer without an order
  after_end,
};

const char* name(SessionState state);
const char* name(Sender sender);
const char* name(Refusal refusal);
// One sentence for docs and errors.
const char* sentence(Refusal refusal);

struct Verdict {
  Refusal refusal = Refusal::none;
  SessionState next{};  // where the message is allowed
};
// One cell of the table.
Verdict verdict(Role role, SessionState state, Kind kind, Sender sender);

class Session {
 public:
  explicit Session(Role role) : role_(role) {}
  SessionState state() const { return state_; }
  Role role() const { return role_; }
  // Takes one step, or throws ProtocolError{not_allowed} and stays.
  void step(Kind kind, Sender sender);

 private:
  Role role_;
  SessionState state_ = SessionState::connected;
};

}  // namespace tandem::protocol
