// What a back end offers the engine: memory where the spheres are, and loops over them. engine/engine_of.hpp
// is written against this concept; backend/cpu/exec_cpu.hpp and backend/cuda/exec_cuda.cuh fulfil it, and
// both give the same bits. Work is done in the order in which it is asked for, but only downloads wait for
// it.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/host_device.hpp"
#include "dem_server/base/group.hpp"

namespace tandem::dem {

namespace detail {

struct AnyLoop {
  TANDEM_HD void operator()(std::uint32_t) const {}
};
struct AnySharedLoop {
  template <class Group>
  TANDEM_HD void operator()(std::uint32_t, const Group&) const {}
};
struct AnyWork {
  void operator()() const {}
};

}  // namespace detail

// Buffer<T>: an array where the spheres are. resize(n) leaves contents undefined or zero; data() is valid
// there alone.
template <class B>
concept DeviceBuffer = std::movable<B> && requires(B b, const B& c, std::size_t n) {
  b.resize(n);
  b.data();
  { c.size() } -> std::same_as<std::size_t>;
};

template <class E>
concept BackEnd = DeviceBuffer<typename E::template Buffer<std::uint32_t>> &&
    requires(E exec, const E& fixed, typename E::template Buffer<std::uint32_t> buffer, std::uint32_t n,
             std::size_t size, std::span<const std::uint32_t> from, std::span<std::uint32_t> to,
             detail::AnyLoop loop, detail::AnySharedLoop shared, detail::AnyWork work) {
  // See backend/traits.hpp.
  { E::on_host } -> std::convertible_to<bool>;
  { E::pairs_once } -> std::convertible_to<bool>;
  { E::read_ahead } -> std::convertible_to<std::size_t>;

  // Memory. A buffer that is too short for an upload becomes as long as that; grow() keeps the contents;
  // download() takes further (buffer, span) pairs, for which it waits once.
  exec.upload(buffer, from);
  exec.download(buffer, to);
  exec.copy(buffer, buffer);
  exec.grow(buffer, size);
  exec.zero(buffer, size);

  // Loops over 0 .. n - 1. The iterations of one call run in any order and at once: each writes what no other
  // one reads or writes.
  exec.for_each(n, loop);
  // Each iteration is done by a group of threads (base/group.hpp).
  exec.for_each_shared(n, shared);
  // Two pieces of work that need nothing of each other.
  exec.at_once(work, work);
  exec.exclusive_sum(buffer, n);

  // Arrays have moved, or constants of functors have changed: captured work is of no use.
  exec.forget_captured();
  // The spheres do not fit into shared memory: more room, or steps through memory from now on.
  exec.enlarge_regions();
  { fixed.regions() } -> std::convertible_to<std::uint32_t>;
  { fixed.threads() } -> std::convertible_to<unsigned>;
};

// Beyond these, which have a form that a concept can check, a back end has members whose arguments are
// functors of the particle method:
//
//   step(n, MicroStep, rows)                one micro step of n spheres; `rows` of loads, see View::load
//   run_window(view, window, rebuild, step) steps until the window is done, or WindowProgress::error is set;
//   calls
//                                           rebuild where a rebuild is due
//   sort_into_cells(n, cells, cell_of, key, scratch, start, source)
//                                           a stable counting sort: start (cells + 2), source (n)
//   fill_lists(n, FillPairs)                for_each_shared, for a functor whose entries of a sphere lie
//   together account<count>(n, book)                 adds what book(i, tally) records to view.totals
//   take_up_lists(view)                     after a rebuild

}  // namespace tandem::dem
