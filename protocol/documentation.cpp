#include "protocol/documentation.hpp"

#include "protocol/facts.hpp"
#include "protocol/layout.hpp"
#include "protocol/session.hpp"

namespace tandem::protocol {
namespace {

std::string code(const std::string& text) {
  return "`" + text + "`";
}

std::string messages() {
  std::string table = "| code | message | sender | meaning |\n|---|---|---|---|\n";
  for (const Kind kind : all_kinds)
    table += "| " + std::to_string(static_cast<unsigned>(kind)) + " | " + code(name(kind)) + " | " +
             name(sender_of(kind)) + " | " + meaning_of(kind) + " |\n";
  return table;
}

std::string states(Role role) {
  std::string table = "| state | who speaks | message → next state |\n|---|---|---|\n";
  for (const SessionState state : all_states) {
    std::string moves, speaker = "nobody";
    for (const Kind kind : all_kinds) {
      if (kind == Kind::failure) continue;
      const Verdict v = verdict(role, state, kind, sender_of(kind));
      if (v.refusal != Refusal::none) continue;
      speaker = name(sender_of(kind));
      moves += (moves.empty() ? "" : ", ") + code(name(kind)) + " → " + name(v.next);
    }
    if (moves.empty() && state != SessionState::ended) continue;  // a state of the other role
    table += "| " + std::string(name(state)) + " | " + speaker + " | " + moves + " |\n";
  }
  return table;
}

std::string refusals() {
  std::string table = "| reason | meaning |\n|---|---|\n";
  for (int i = 1; i <= static_cast<int>(Refusal::after_end); ++i) {
    const auto refusal = static_cast<Refusal>(i);
    table += "| " + code(name(refusal)) + " | " + sentence(refusal) + " |\n";
  }
  return table;
}

std::string records() {
  std::string table;
#define RECORD(record, meaning)                                                              \
  table += "**" #record "**, " + std::to_string(sizeof(record)) + " bytes: " meaning "\n\n"; \
  table += "| offset | bytes | field | meaning |\n|---|---|---|---|\n";
#define FIELD(record, field, meaning)                                                                       \
  table += "| " + std::to_string(offsetof(record, field)) + " | " + std::to_string(sizeof(record::field)) + \
           " | " + code(#field) + " | " meaning " |\n";
#define END(record) table += "\n";
#include "protocol/records.def"
#undef RECORD
#undef FIELD
#undef END
  table.pop_back();
  return table;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> documentation_tables() {
  return {
      {"messages", messages()}, {"states of mbd", states(Role::mbd)}, {"states of dem", states(Role::dem)},
      {"refusals", refusals()}, {"facts", facts_as_markdown()},       {"records", records()}};
}

}  // namespace tandem::protocol
