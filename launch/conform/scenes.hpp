// The small scenes of the judge, scenes/ROLE/NAME.json. Each has one thing to be seen, with a closed form.
// Those of bodies and grains are of format 1.0, which participants of earlier releases read as well.
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
// The same scene with the simplest contact, `hooke` without friction, for a particle participant that does
// not know Hertz's law: no closed form of the checks depends on the law.
std::string with_simplest_contact(const std::string& text);
std::string with_end_time(const std::string& text, double end_time);

}  // namespace tandem::conform
