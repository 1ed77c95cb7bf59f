#include "launch/coordinator/facts.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {

using Json = nlohmann::ordered_json;

Json parse_facts(protocol::Role role, const std::string& facts) {
  const auto refuse = [&](const std::string& problem) {
    throw Error(ErrorCode::protocol, "sent facts " + problem + ": " + printable(shortened(facts)),
                protocol::name(role));
  };
  // Copying and writing JSON is recursive.
  constexpr int deepest = 64;
  const auto bounded = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) refuse("that are nested more than " + std::to_string(deepest) + " deep");
    return true;
  };
  Json sent = Json::parse(facts, bounded, false);
  if (!sent.is_object()) refuse("that are no JSON object in UTF-8");
  const auto warnings = sent.find("warnings");
  if (warnings != sent.end() &&
      !(warnings->is_array() &&
        std::ranges::all_of(*warnings, [](const Json& item) { return item.is_string(); })))
    refuse("whose warnings are no list of sentences");
  return sent;
}

}  // namespace tandem::launch
