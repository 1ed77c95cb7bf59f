// The scenes of the source tree, compiled into the program, so that it runs without the tree.
#pragma once

#include <string_view>
#include <vector>

namespace tandem::fuzz {

std::vector<std::string_view> shipped_scenes();
// The scene with this "name".
std::string_view shipped_scene(std::string_view name);

}  // namespace tandem::fuzz
