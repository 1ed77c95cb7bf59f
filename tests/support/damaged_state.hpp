// A state on disk with wrong values and a digest that fits them, as no accident makes it: what reads it has
// to look at the values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tandem::test {

// Writes the state `from` to `to` with one of its arrays changed: a bit, a value, its length, or all of it.
// Says what was changed. Equal seeds change the same.
std::string damage_state(const std::filesystem::path& from, const std::filesystem::path& to,
                         std::uint64_t seed);

}  // namespace tandem::test
