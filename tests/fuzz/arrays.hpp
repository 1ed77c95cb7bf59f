// HDF5 files as lists of arrays. The library itself does not bear damage to its own structure; what stands in
// a file that it can read is ours to check.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/fuzz/mutator.hpp"

namespace tandem::fuzz {

enum class Number : std::uint8_t { bytes, uint32, int32, uint64, float32, float64 };

struct Array {
  std::string name;  // with its groups: "accounts/energy"
  Number number{};
  Bytes values;
};

// All arrays of a file.
std::vector<Array> arrays_of(const std::filesystem::path& file);

Bytes packed(const std::vector<Array>& arrays);
// Of any bytes. Values are whole numbers of their kind, and names are such that a file can have them all.
std::vector<Array> unpacked(std::span<const std::byte> bytes);

}  // namespace tandem::fuzz
