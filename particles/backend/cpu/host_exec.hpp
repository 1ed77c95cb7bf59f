// Host memory and a team of threads: what the CPU back end of every particle solver offers, see
// dem_server/backend/concept.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "particles/backend/traits.hpp"
#include "particles/base/range.hpp"
#include "particles/base/thread_pool.hpp"
#include "particles/grid/index_order.hpp"

namespace tandem::particles {

class HostExec : public CpuTraits {
 public:
  template <class T>
  class Buffer {
   public:
    void resize(std::size_t n) { data_.resize(n); }
    T* data() { return data_.data(); }
    const T* data() const { return data_.data(); }
    std::size_t size() const { return data_.size(); }

   private:
    std::vector<T> data_;
  };

  explicit HostExec(unsigned threads) : pool_(std::make_unique<ThreadPool>(threads)) {}

  template <class T>
  void upload(Buffer<T>& to, std::span<const T> from) {
    to.resize(std::max(to.size(), from.size()));
    std::copy(from.begin(), from.end(), to.data());
  }
  template <class T, class... More>
  void download(const Buffer<T>& from, std::span<T> to, const More&... more) {
    std::copy_n(from.data(), to.size(), to.begin());
    if constexpr (sizeof...(more) > 0) download(more...);
  }
  void mark() {}
  template <class T>
  void download_marked(const Buffer<T>& from, std::span<T> to) {
    download(from, to);
  }
  template <class T>
  void copy(const Buffer<T>& from, Buffer<T>& to) {
    to.resize(from.size());
    std::copy_n(from.data(), from.size(), to.data());
  }
  template <class T>
  void grow(Buffer<T>& b, std::size_t n) {
    if (b.size() < n) b.resize(n);
  }
  template <class T>
  void zero(Buffer<T>& b, std::size_t n) {
    std::fill_n(b.data(), n, T{});
  }

  template <class F>
  void for_each(std::uint32_t n, F f) {
    pool_->run([&](unsigned thread) {
      const auto [begin, end] = share(n, thread);
      for (std::uint32_t i = begin; i < end; ++i) f(i);
    });
  }

  // Sorts n spheres by cell; cell_of(i) < cells. Spheres of one cell keep their `order`. start: first
  // position of each cell in `source` (cells + 2); source: former index of each sphere (n); key: memory for
  // the sort (n).
  template <class CellOf>
  void sort_into_cells(std::uint32_t n, std::uint32_t cells, CellOf cell_of, std::uint32_t* key,
                       std::uint32_t*, Buffer<std::uint32_t>& start, Buffer<std::uint32_t>& source,
                       IndexOrder order = {}) {
    for_each(n, [cell_of, key](std::uint32_t i) { key[i] = cell_of(i); });
    // Next free position of a cell; in the end that is the start of the cell after it.
    std::uint32_t* next = start.data() + 1;
    std::fill_n(start.data(), cells + 2, 0);
    for (std::uint32_t i = 0; i < n; ++i) ++next[key[i] + 1];
    std::partial_sum(next, next + cells + 1, next);
    for (std::uint32_t place = 0; place < n; ++place) {
      const std::uint32_t i = order.index(place);
      source.data()[next[key[i]]++] = i;
    }
  }
  template <class T>
  void exclusive_sum(Buffer<T>& counts, std::uint32_t n) {
    std::exclusive_scan(counts.data(), counts.data() + n, counts.data(), T{});
  }

  unsigned threads() const { return pool_->size(); }

 protected:
  Range share(std::uint32_t n, unsigned thread) const {
    const auto part = [&](unsigned t) {
      return static_cast<std::uint32_t>(std::uint64_t{n} * t / pool_->size());
    };
    return {part(thread), part(thread + 1)};
  }

  std::unique_ptr<ThreadPool> pool_;
};

}  // namespace tandem::particles
