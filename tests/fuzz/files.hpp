// Reads and writes whole files, for targets that take a path.
#pragma once

#include <filesystem>
#include <span>

#include "tests/fuzz/mutator.hpp"

namespace tandem::fuzz {

void put(const std::filesystem::path& file, std::span<const std::byte> bytes);
Bytes get(const std::filesystem::path& file);

// Some targets take one of several files: the first byte of an input, modulo the number of files, is the
// choice.
Bytes choice(unsigned which, std::span<const std::byte> bytes);
// Empty inputs choose 0.
unsigned chosen(std::span<const std::byte>& input, unsigned of);

}  // namespace tandem::fuzz
