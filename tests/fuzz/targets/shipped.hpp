// The scenes of the source tree, inside the program: it runs where the tree is not.
#pragma once

#include <string_view>
#include <vector>

namespace tandem::fuzz {

std::vector<std::string_view> shipped_scenes();
// The one whose "name" this is.
std::string_view shipped_scene(std::string_view name);

}  // namespace tandem::fuzz
