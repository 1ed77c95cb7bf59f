// Facts that a solver sends for summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "protocol/messages.hpp"

namespace tandem::launch {

// Error{protocol} where they are no JSON object in UTF-8, are nested deeper than any of ours, or have
// warnings that are no sentences.
nlohmann::ordered_json parse_facts(protocol::Role role, const std::string& facts);

}  // namespace tandem::launch
