// Scenes may give an angle in degrees, an orientation in several ways, and a pose relative to a body. The
// plain form of a scene has one way for each: radians, quaternions, and poses in the world (of a wall or
// shape: in its body). Solvers receive scenes in the plain form only.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tandem::scene {

// Brings a document that conforms to the schema into the plain form. No list or object moves, so that the
// path of a value is still that in the file. Returns whether there was anything to replace.
bool to_plain_form(nlohmann::json& document, const std::string& origin);

}  // namespace tandem::scene
