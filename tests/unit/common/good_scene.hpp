// A small scene with every kind of object; tests change it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tandem::scene::test {

extern const char* const good_scene_text;
nlohmann::json good_scene();

}  // namespace tandem::scene::test
