// JSON text -> document. Refuses what the JSON library would let pass: a key given twice in one object.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tandem::scene {

nlohmann::json read_document(const std::string& text, const std::string& origin);

}  // namespace tandem::scene
