// A state on disk with wrong values and a matching digest, which no accident produces: the reader has to
// check the values themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace tandem::test {

// Writes the state `from` to `to` with one of its arrays changed: a bit, a value, its length, or all of it.
// Returns a description of the change. Equal seeds give equal changes.
std::string damage_state(const std::filesystem::path& from, const std::filesystem::path& to,
                         std::uint64_t seed);

// Writes the state `from` to `to` with the bytes of the array `name` changed by `change`.
void change_state(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& name,
                  const std::function<void(std::span<std::byte>)>& change);

}  // namespace tandem::test
