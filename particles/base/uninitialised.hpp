// An array whose elements are written before they are read. In a kernel such an array is in local memory, and
// initialising it would cost more memory traffic than the work that uses it.
#pragma once

#include <type_traits>

#include "common/host_device.hpp"

namespace tandem::particles {

template <class T, int N>
struct UninitialisedArray {
  static_assert(std::is_trivially_copyable_v<T>);
  alignas(T) unsigned char bytes[sizeof(T) * N];

  TANDEM_HD T* data() { return reinterpret_cast<T*>(bytes); }
  TANDEM_HD const T* data() const { return reinterpret_cast<const T*>(bytes); }
  TANDEM_HD T& operator[](int i) { return data()[i]; }
  TANDEM_HD const T& operator[](int i) const { return data()[i]; }
};

}  // namespace tandem::particles
