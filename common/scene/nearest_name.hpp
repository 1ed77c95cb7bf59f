// Suggestions for an unknown name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`
// (optimal string alignment distance).
std::size_t edit_distance(std::string_view a, std::string_view b);

// The name that `unknown` may be a misspelling of; nullptr: none is similar.
const std::string* nearest_name(std::string_view unknown, const std::vector<std::string>& names);

// "did you mean 'glass'?" where a similar name exists; else "known materials: glass, steel"; else "there are
// no materials". `kind` is the plural noun of the names.
std::string suggest_name(std::string_view unknown, const std::vector<std::string>& names,
                         std::string_view kind);

}  // namespace tandem
