// Facts that a solver sends for summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "protocol/messages.hpp"

namespace tandem::launch {

// Throws Error{protocol} where they are not a JSON object in UTF-8, are nested too deeply, or have warnings
// that are not texts.
nlohmann::ordered_json parse_facts(protocol::Role role, const std::string& facts);

}  // namespace tandem::launch
