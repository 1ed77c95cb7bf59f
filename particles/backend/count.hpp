// A back end that computes nothing and allocates nothing. EngineMemory on this back end yields the number of
// bytes that an engine takes on the back end with the same traits.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "particles/backend/traits.hpp"

namespace tandem::particles {

template <class Traits>
class CountExec : public Traits {
 public:
  template <class T>
  class Buffer {
   public:
    void resize(std::size_t n) { size_ = n; }
    T* data() { return nullptr; }
    const T* data() const { return nullptr; }
    std::size_t size() const { return size_; }

   private:
    std::size_t size_ = 0;
  };

  template <class T>
  void upload(Buffer<T>& to, std::span<const T> from) {
    grow(to, from.size());
  }
  template <class T>
  void copy(const Buffer<T>& from, Buffer<T>& to) {
    to.resize(from.size());
  }
  template <class T>
  void grow(Buffer<T>& b, std::size_t n) {
    b.resize(std::max(b.size(), n));
  }
};

}  // namespace tandem::particles
