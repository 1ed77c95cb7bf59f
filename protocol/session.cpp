#include "protocol/session.hpp"

#include <algorithm>

#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

enum class For : std::uint8_t { any, mbd, dem };  // dem: all load solvers

struct Transition {
  For role;
  SessionState state;
  Kind message;
  SessionState next;
  bool serves(Role r) const { return role == For::any || (role == For::mbd) == (r == Role::mbd); }
};

constexpr Transition transitions[] = {
#define TRANSITION(role, state, message, next) \
  {For::role, SessionState::state, Kind::message, SessionState::next},
#include "protocol/session.def"
#undef TRANSITION
};

bool known(Kind kind) {
  return std::ranges::find(all_kinds, kind) != all_kinds.end();
}

bool owes_answer(SessionState state) {
  return state >= SessionState::configuring && state != SessionState::ready && state != SessionState::ended;
}

// The reason why the table has no such line.
Refusal reason(Role role, SessionState state, Kind kind) {
  const bool spoken = std::ranges::any_of(
      transitions, [&](const Transition& t) { return t.message == kind && t.serves(role); });
  if (!spoken) return Refusal::wrong_role;
  if (kind == Kind::hello || kind == Kind::welcome || kind == Kind::refuse)
    return state < SessionState::registered && kind != Kind::hello ? Refusal::not_registered
                                                                   : Refusal::repeated;
  if (state < SessionState::registered) return Refusal::not_registered;
  if (kind == Kind::configure) return Refusal::repeated;
  if (state == SessionState::registered) return Refusal::not_configured;
  if (sender_of(kind) == Sender::coordinator) return Refusal::answer_owed;
  return owes_answer(state) ? Refusal::wrong_answer : Refusal::not_asked;
}

std::string allowed_in(Role role, SessionState state) {
  std::string list;
  for (const Transition& t : transitions)
    if (t.state == state && t.serves(role)) list += (list.empty() ? "" : ", ") + std::string(name(t.message));
  return list;
}

}  // namespace

Sender sender_of(Kind kind) {
  switch (kind) {
#define MESSAGE(name, code, sender, meaning) \
  case Kind::name:                           \
    return Sender::sender;
#include "protocol/messages.def"
#undef MESSAGE
  }
  return Sender::either;
}

const char* meaning_of(Kind kind) {
  switch (kind) {
#define MESSAGE(name, code, sender, meaning) \
  case Kind::name:                           \
    return meaning;
#include "protocol/messages.def"
#undef MESSAGE
  }
  return "";
}

const char* name(SessionState state) {
  switch (state) {
    case SessionState::connected:
      return "connected";
    case SessionState::greeted:
      return "greeted";
    case SessionState::registered:
      return "registered";
    case SessionState::configuring:
      return "configuring";
    case SessionState::ready:
      return "ready";
    case SessionState::predicting:
      return "predicting";
    case SessionState::extrapolating:
      return "extrapolating";
    case SessionState::controlling:
      return "controlling";
    case SessionState::moving:
      return "moving";
    case SessionState::loading:
      return "loading";
    case SessionState::linearising:
      return "linearising";
    case SessionState::saving:
      return "saving";
    case SessionState::restoring:
      return "restoring";
    case SessionState::checkpointing:
      return "checkpointing";
    case SessionState::resuming:
      return "resuming";
    case SessionState::observing:
      return "observing";
    case SessionState::copying:
      return "copying";
    case SessionState::finishing:
      return "finishing";
    case SessionState::ended:
      return "ended";
  }
  return "unknown";
}

const char* name(Sender sender) {
  switch (sender) {
    case Sender::coordinator:
      return "coordinator";
    case Sender::participant:
      return "participant";
    case Sender::either:
      return "either";
  }
  return "unknown";
}

const char* name(Refusal refusal) {
  switch (refusal) {
    case Refusal::none:
      return "none";
    case Refusal::unknown_message:
      return "unknown_message";
    case Refusal::wrong_sender:
      return "wrong_sender";
    case Refusal::wrong_role:
      return "wrong_role";
    case Refusal::not_registered:
      return "not_registered";
    case Refusal::not_configured:
      return "not_configured";
    case Refusal::repeated:
      return "repeated";
    case Refusal::answer_owed:
      return "answer_owed";
    case Refusal::wrong_answer:
      return "wrong_answer";
    case Refusal::not_asked:
      return "not_asked";
    case Refusal::after_end:
      return "after_end";
  }
  return "unknown";
}

const char* sentence(Refusal refusal) {
  switch (refusal) {
    case Refusal::none:
      return "allowed";
    case Refusal::unknown_message:
      return "there is no message of this code";
    case Refusal::wrong_sender:
      return "only the other side sends this message";
    case Refusal::wrong_role:
      return "this message belongs to the other solver";
    case Refusal::not_registered:
      return "the participant is not registered yet";
    case Refusal::not_configured:
      return "the participant is not configured yet";
    case Refusal::repeated:
      return "registration and configuration happen once";
    case Refusal::answer_owed:
      return "the participant still owes the answer to the last order";
    case Refusal::wrong_answer:
      return "this does not answer the last order";
    case Refusal::not_asked:
      return "nothing was asked";
    case Refusal::after_end:
      return "the session has ended";
  }
  return "unknown";
}

Verdict verdict(Role role, SessionState state, Kind kind, Sender sender) {
  if (!known(kind)) return {Refusal::unknown_message, state};
  if (state == SessionState::ended) return {Refusal::after_end, state};
  if (kind == Kind::failure) return {Refusal::none, SessionState::ended};
  if (sender_of(kind) != sender) return {Refusal::wrong_sender, state};
  for (const Transition& t : transitions)
    if (t.state == state && t.message == kind && t.serves(role)) return {Refusal::none, t.next};
  return {reason(role, state, kind), state};
}

void Session::step(Kind kind, Sender sender) {
  const Verdict v = verdict(role_, state_, kind, sender);
  if (v.refusal != Refusal::none) {
    const std::string message =
        known(kind) ? std::string(name(kind)) : "message " + std::to_string(static_cast<unsigned>(kind));
    const std::string allowed = allowed_in(role_, state_);
    throw ProtocolError(
        Violation::not_allowed,
        message + " from the " + name(sender) + " in state " + name(state_) + ": " + sentence(v.refusal), {},
        allowed.empty() ? "nothing may follow" : "allowed: " + allowed + ", failure");
  }
  state_ = v.next;
}

}  // namespace tandem::protocol
