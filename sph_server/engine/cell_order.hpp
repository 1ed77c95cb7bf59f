// The order of particles in memory: that of the cells that they were in at one time, so that neighbours are
// near each other. Particles keep their numbers.
#pragma once

#include <cstdint>
#include <utility>

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

template <class T>
struct TakeEntry {
  const std::uint32_t* source = nullptr;
  const T* from = nullptr;
  T* to = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const { to[i] = from[source[i]]; }
};

// Entry k of each array, and of `located_`, becomes what entry source[k] was.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::take(const Buffer<std::uint32_t>& source, std::size_t n) {
  const auto take_of = [&](auto& array) {
    using T = std::remove_pointer_t<decltype(array.data())>;
    Buffer<T> taken;
    exec_.grow(taken, array.size());
    exec_.for_each(static_cast<std::uint32_t>(n), TakeEntry<T>{source.data(), array.data(), taken.data()});
    array = std::move(taken);
  };
  Memory::each([&](const char*, auto& array) { take_of(array); }, memory_);
  take_of(located_);
  count_ = n;
  use_arrays();
}

template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::put_in_order_of_cells() {
  sort_into_cells(located_);
  take(in_cell_, count_);
}

}  // namespace tandem::sph
