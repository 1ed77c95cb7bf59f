// One step of a checksum that detects damage, not forgery.
#pragma once

#include <cstdint>

namespace tandem {

// Odd constants with well-spread bits (fractional parts of the golden ratio and of sqrt 3).
inline constexpr std::uint64_t odd_0 = 0x9e3779b97f4a7c15, odd_1 = 0xbb67ae8584caa73b;

// Combines both halves of a product of 128 bits: a changed bit of `sum` or `word`, also the highest one,
// changes bits of the whole result, and which ones depends on all other bits. A few changed bits in the next
// word cannot undo it.
constexpr std::uint64_t mix_word(std::uint64_t sum, std::uint64_t word) {
  __extension__ using Product = unsigned __int128;
  const Product product = Product{sum ^ word} * odd_0;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

}  // namespace tandem
