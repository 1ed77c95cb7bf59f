// A back end that computes nothing and allocates nothing: an engine on it knows how much memory it would take
// on back end Of. Same interface as exec_cpu.hpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tandem::dem {

template <class Of>
class CountExec {
 public:
  static constexpr bool on_host = Of::on_host;
  static constexpr bool pairs_once = Of::pairs_once;
  static constexpr std::size_t read_ahead = Of::read_ahead;

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
  template <class T, class... More>
  void download(const Buffer<T>&, std::span<T>, const More&...) {}
  template <class T>
  void copy(const Buffer<T>& from, Buffer<T>& to) {
    to.resize(from.size());
  }
  template <class T>
  void grow(Buffer<T>& b, std::size_t n) {
    b.resize(std::max(b.size(), n));
  }
  template <class T>
  void zero(Buffer<T>&, std::size_t) {}

  template <class F>
  void for_each(std::uint32_t, F) {}
  template <class F>
  void for_each_shared(std::uint32_t, F) {}
  template <class F>
  void fill_lists(std::uint32_t, F) {}
  template <class First, class Second>
  void at_once(First, Second) {}
  template <class... Arguments>
  void step(const Arguments&...) {}
  template <unsigned books, class Book>
  void account(std::uint32_t, const Book&) {}
  template <class... Arguments>
  void sort_into_cells(const Arguments&...) {}
  template <class T>
  void exclusive_sum(Buffer<T>&, std::uint32_t) {}
  template <class... Arguments>
  void run_window(const Arguments&...) {}
  template <class View>
  void take_up_lists(const View&) {}
  void forget_captured() {}
  void enlarge_regions() {}
  std::uint32_t regions() const { return 0; }
  unsigned threads() const { return 1; }
};

}  // namespace tandem::dem
