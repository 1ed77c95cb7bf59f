// HDF5 files as lists of arrays. The HDF5 library does not survive damage to the structure of a file; tandem
// must check the contents of files that the library can read.
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
// Decodes arrays from any bytes. The values of an array fill whole numbers of its kind, and a file can hold
// all the names.
std::vector<Array> unpacked(std::span<const std::byte> bytes);

}  // namespace tandem::fuzz
