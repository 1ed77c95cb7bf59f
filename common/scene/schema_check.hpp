// Validates a document against scene/schema.json and describes its first fault in a sentence.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace tandem::scene {

struct Fault {
  std::string path, problem, hint;
};

// valijson decides whether the document is valid.
bool conforms(const nlohmann::json& document);

// First fault of a document that does not conform, found by a walk along the same schema.
std::optional<Fault> first_fault(const nlohmann::json& document);

// Throws Error{scene} with the first fault of a document that does not conform.
void check_schema(const nlohmann::json& document, const std::string& origin);

// The same for another kind of file, whose schema uses only the keywords that scene/schema.json uses.
void check_schema(const nlohmann::json& schema, const nlohmann::json& document, const std::string& origin);

}  // namespace tandem::scene
