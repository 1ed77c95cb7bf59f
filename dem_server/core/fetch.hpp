// Loads of data that nobody writes while the kernel runs: a GPU may then take them through its read-only path
// and start them before earlier stores, of which it cannot know that they go elsewhere.
#pragma once

#include <cstddef>
#include <type_traits>

#include "common/host_device.hpp"

namespace tandem::dem {

template <class T>
TANDEM_HD T fetch(const T* from) {
#if defined(__CUDA_ARCH__)
  static_assert(std::is_trivially_copyable_v<T>);
  using Word =
      std::conditional_t<alignof(T) % 16 == 0, int4,
                         std::conditional_t<alignof(T) % 8 == 0, int2,
                                            std::conditional_t<alignof(T) % 4 == 0, int, unsigned char>>>;
  T value;
  for (std::size_t k = 0; k < sizeof(T) / sizeof(Word); ++k)
    reinterpret_cast<Word*>(&value)[k] = __ldg(reinterpret_cast<const Word*>(from) + k);
  return value;
#else
  return *from;
#endif
}

}  // namespace tandem::dem
