// Loads and stores of whole values, in words as wide as their alignment.
#pragma once

#include <cstddef>
#include <type_traits>

#include "common/host_device.hpp"

namespace tandem::particles {

#if defined(__CUDA_ARCH__)
template <class T>
requires std::is_trivially_copyable_v<T>
using WordOf =
    std::conditional_t<alignof(T) % 16 == 0, int4,
                       std::conditional_t<alignof(T) % 8 == 0, int2,
                                          std::conditional_t<alignof(T) % 4 == 0, int, unsigned char>>>;
#endif

// Loads data that no thread writes while the kernel runs. A GPU may then use its read-only path and begin the
// load before earlier stores, because it need not assume that they write the same address.
template <class T>
TANDEM_HD T fetch(const T* from) {
#if defined(__CUDA_ARCH__)
  using Word = WordOf<T>;
  T value;
  for (std::size_t k = 0; k < sizeof(T) / sizeof(Word); ++k)
    reinterpret_cast<Word*>(&value)[k] = __ldg(reinterpret_cast<const Word*>(from) + k);
  return value;
#else
  return *from;
#endif
}

// Stores a value of a type with padding at its end. An assignment preserves the padding, which makes a GPU
// write the rest byte by byte. This function leaves the padding undefined; do not use it for data that is
// written to files.
template <class T>
TANDEM_HD void store(T* to, const T& value) {
#if defined(__CUDA_ARCH__)
  using Word = WordOf<T>;
  for (std::size_t k = 0; k < sizeof(T) / sizeof(Word); ++k)
    reinterpret_cast<Word*>(to)[k] = reinterpret_cast<const Word*>(&value)[k];
#else
  *to = value;
#endif
}

}  // namespace tandem::particles
