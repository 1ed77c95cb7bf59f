// JSON text -> document. Refuses a key that occurs twice in one object, which the JSON library would accept.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tandem::scene {

nlohmann::json read_document(const std::string& text, const std::string& origin);

}  // namespace tandem::scene
