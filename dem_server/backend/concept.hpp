// What a back end offers the engine: memory on the processor that holds the spheres, and loops over them.
// engine/engine_of.hpp is written against this concept. The two back ends, backend/cpu/exec_cpu.hpp and
// backend/cuda/exec_cuda.cuh, give the same bits. A back end executes its calls in order. Calls may return
// before their work is done; only a download waits for it.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/host_device.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/group.hpp"

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

// Buffer<T>: an array on the processor that holds the spheres. resize(n) leaves the contents undefined or
// zero. data() may be dereferenced on that processor only.
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
  // See particles/backend/traits.hpp.
  { E::on_host } -> std::convertible_to<bool>;
  { E::pairs_once } -> std::convertible_to<bool>;
  { E::read_ahead } -> std::convertible_to<std::size_t>;

  // Memory. An upload enlarges a buffer that is too short. grow() keeps the contents. download() accepts
  // further (buffer, span) pairs and waits once for all of them.
  exec.upload(buffer, from);
  exec.download(buffer, to);
  exec.copy(buffer, buffer);
  // mark() is called after a copy; download_marked() waits for the work before the last mark, and another
  // thread may call it while loops run.
  exec.mark();
  exec.download_marked(buffer, to);
  exec.grow(buffer, size);
  exec.zero(buffer, size);

  // Loops over 0 .. n - 1. The iterations of one call run in any order and concurrently: each must write only
  // data that no other iteration reads or writes.
  exec.for_each(n, loop);
  // A group of threads (particles/base/group.hpp) executes each iteration.
  exec.for_each_shared(n, shared);
  // Two independent pieces of work, which may run concurrently.
  exec.at_once(work, work);
  exec.exclusive_sum(buffer, n);

  // To be called when arrays have moved or constants of functors have changed: discards captured work, which
  // refers to the old ones.
  exec.forget_captured();
  // To be called when the spheres do not fit into shared memory: gives the regions more room, or does without
  // regions from now on.
  exec.enlarge_regions();
  { fixed.regions() } -> std::convertible_to<std::uint32_t>;
  { fixed.threads() } -> std::convertible_to<unsigned>;
};

// A concept cannot check the members whose arguments are functors of the particle method:
//
//   step(n, MicroStep, rows)   One micro step of n spheres. `rows`: rows of the loads, see View::load.
//   run_window(view, window, rebuild, step)
//                              Runs steps until the window is done or WindowProgress::error is set. Calls
//                              rebuild where a rebuild is due.
//   sort_into_cells(n, cells, cell_of, key, scratch, start, source, order)
//                              A stable counting sort into start (cells + 2) and source (n).
//   fill_lists(n, FillPairs)   Like for_each_shared, for a functor that writes a sphere's entries next to
//                              each other.
//   account<count>(n, f)       Adds the amounts that f(i, tally) records to view.totals.
//   prepare_lists(view)        To be called after a rebuild.
//   let_host_rebuild()         To be called before the first window where the host takes part in rebuilds.
//   RankExchange<Real, spin>   What ranks exchange, see backend/cpu/rank_exchange_cpu.hpp.

}  // namespace tandem::dem
