// The small scenes of the judge. Each has one thing to be seen, with a closed form.
#pragma once

#include <string>
#include <vector>

#include "protocol/messages.hpp"

namespace tandem::conform {

struct BuiltInScene {
  const char* name;
  protocol::Role role;  // of the participant that is judged on it
  const char* text;     // JSON
};
const std::vector<BuiltInScene>& built_in_scenes();
// Throws Error{internal} where there is none of this name.
const BuiltInScene& built_in_scene(const std::string& name);

}  // namespace tandem::conform
