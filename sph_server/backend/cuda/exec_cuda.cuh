// The CUDA back end of a liquid. Its members are those of backend/cpu/exec_cpu.hpp.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cub/device/device_select.cuh>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <thrust/iterator/counting_iterator.h>

#include "particles/backend/cuda/block_sum.cuh"
#include "particles/backend/cuda/device_exec.cuh"
#include "particles/backend/cuda/warp_group.cuh"
#include "sph_server/backend/list.hpp"
#include "sph_server/step/body_sum.hpp"
#include "sph_server/step/wall_sums.hpp"

namespace tandem::sph {

// Counts the entries of each particle.
template <class Entry, class Find>
struct CountEntries {
  Find find;
  std::uint32_t* count;
  __device__ void operator()(std::uint32_t i, particles::OneThread group) const {
    std::uint32_t sum = 0;
    find(i, group, [&](Entry, bool exists) { sum += exists ? 1 : 0; });
    count[i] = sum;
  }
};
template <class Entry, class Find>
struct WriteEntries {
  Find find;
  const std::uint32_t* start;
  Entry* entry;
  __device__ void operator()(std::uint32_t i, particles::OneThread group) const {
    std::uint32_t at = start[i];
    find(i, group, [&](Entry e, bool exists) {
      if (exists) entry[at++] = e;
    });
  }
};

inline constexpr unsigned list_warps = 8;             // of a block
inline constexpr std::uint32_t most_in_shared = 320;  // entries of a warp; few particles have more
// Finds the entries of each particle once, by a warp, and takes room for those of a block from `total`. Where
// there is not enough room, it counts all the same.
template <class Entry, class Find>
__global__ void __launch_bounds__(list_warps* particles::WarpGroup::size, 4)
    list_kernel(std::uint32_t n, Find find, std::uint32_t* start, std::uint32_t* end, Entry* entry,
                std::uint32_t room, unsigned long long* total) {
  static_assert(std::is_trivially_copyable_v<Entry>);
  __shared__ alignas(Entry) unsigned char space[list_warps * most_in_shared * sizeof(Entry)];
  __shared__ std::uint32_t counts[list_warps], begin;
  __shared__ bool fits;
  const particles::WarpGroup group;
  const unsigned warp = threadIdx.x / particles::WarpGroup::size,
                 lane = threadIdx.x % particles::WarpGroup::size;
  const std::uint32_t i = blockIdx.x * list_warps + warp;
  Entry* const found = reinterpret_cast<Entry*>(space) + warp * most_in_shared;
  Entry* to = found;
  std::uint32_t most = most_in_shared;
  // Once more for particles with too many entries. The search is a loop's body, so that it is compiled once.
#pragma unroll 1
  for (bool again = false;; again = true) {
    std::uint32_t count = 0;
    if (i < n)
      find(i, group, [&](Entry e, bool exists) {
        std::uint32_t of_group = 0;
        const std::uint32_t mine = count + group.before(exists, of_group);
        if (exists && mine < most) to[mine] = e;
        count += of_group;
      });
    if (again) return;
    if (lane == 0) counts[warp] = count;
    __syncthreads();
    if (threadIdx.x == 0) {
      std::uint32_t of_block = 0;
      for (const std::uint32_t c : counts) of_block += c;
      const unsigned long long before = atomicAdd(total, static_cast<unsigned long long>(of_block));
      fits = before + of_block <= room;
      begin = static_cast<std::uint32_t>(before);
    }
    __syncthreads();
    if (i >= n || !fits) return;
    std::uint32_t at = begin;
    for (unsigned w = 0; w < warp; ++w) at += counts[w];
    if (lane == 0) {
      start[i] = at;
      end[i] = at + count;
    }
    if (count <= most_in_shared) {
      for (std::uint32_t k = lane; k < count; k += particles::WarpGroup::size) entry[at + k] = found[k];
      return;
    }
    to = entry + at;
    most = count;
  }
}

// A warp drops entries of one of the n particles listed, and moves the others together.
template <class Entry, class Keep>
__global__ void __launch_bounds__(particles::block_threads)
    keep_kernel(std::uint32_t n, const std::uint32_t* particle, Keep keep, const std::uint32_t* start,
                std::uint32_t* end, Entry* entry) {
  const particles::WarpGroup group;
  const unsigned lane = threadIdx.x % particles::WarpGroup::size;
  const std::uint32_t k = (blockIdx.x * blockDim.x + threadIdx.x) / particles::WarpGroup::size;
  if (k >= n) return;
  const std::uint32_t i = particle[k], last = end[i];
  std::uint32_t to = start[i];
  for (std::uint32_t from = to; from < last; from += particles::WarpGroup::size) {
    const bool exists = from + lane < last;
    const Entry e = entry[exists ? from + lane : from];
    std::uint32_t kept = 0;
    const bool stays = exists && keep(i, e);
    const std::uint32_t mine = to + group.before(stays, kept);
    if (stays) entry[mine] = e;
    to += kept;
  }
  __syncwarp();
  if (group.first()) end[i] = to;
}

// The numbers below n for which where(i) holds.
template <class Where>
struct Chosen {
  std::uint32_t n;
  Where where;
  const std::uint32_t* number;  // these, or null: each thread then asks for itself
  const std::uint32_t* count;   // of them

  // Where they are few, threads of a warp that would wait for each other stand aside.
  template <class F>
  __device__ void call(std::uint32_t thread, F f) const {
    constexpr std::uint32_t apart = 8, few = 1u << 15;
    if (!number) {
      if (thread < n && where(thread)) f(thread);
      return;
    }
    const std::uint32_t numbers = *count, spread = numbers <= few && numbers <= n / apart ? apart : 1,
                        k = thread / spread;
    if (thread % spread == 0 && k < numbers) f(number[k]);
  }
};
template <class Where, class F>
__global__ void __launch_bounds__(particles::block_threads) for_each_where_kernel(Chosen<Where> chosen, F f) {
  chosen.call(blockIdx.x * blockDim.x + threadIdx.x, f);
}
// Of two tasks side by side, each with half of the blocks.
template <class A, class F, class B, class G>
__global__ void __launch_bounds__(particles::block_threads, 3)
    for_each_of_two_kernel(Chosen<A> a, F f, Chosen<B> b, G g) {
  const unsigned half = gridDim.x / 2, thread = blockIdx.x % half * blockDim.x + threadIdx.x;
  if (blockIdx.x < half)
    a.call(thread, f);
  else
    b.call(thread, g);
}

// The value that another thread of the warp has. All threads of the mask call it together.
template <class T>
__device__ T value_of(const T& own, unsigned lane, unsigned mask) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(int) == 0);
  T other;
  for (std::size_t k = 0; k < sizeof(T) / sizeof(int); ++k)
    reinterpret_cast<int*>(&other)[k] =
        __shfl_sync(mask, reinterpret_cast<const int*>(&own)[k], static_cast<int>(lane));
  return other;
}
// The value that the thread at this distance has.
template <class T>
__device__ T exchanged(const T& own, unsigned distance) {
  return value_of(own, threadIdx.x % particles::WarpGroup::size ^ distance, ~0u);
}

struct EntryTotal {
  std::uint64_t entries = 0;
  __host__ __device__ void add(const EntryTotal& b) { entries += b.entries; }
};
struct AddCount {
  const std::uint32_t* count;
  __device__ void operator()(std::uint32_t i, EntryTotal& total) const { total.entries += count[i]; }
};

// `lanes` threads of a warp have one particle.
template <class Sum>
__global__ void __launch_bounds__(particles::block_threads) sum_over_lanes_kernel(std::uint32_t n, Sum sum) {
  const std::uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x, i = thread / lanes;
  const bool exists = i < n;
  auto s = sum.of_lane(exists ? i : n - 1, thread % lanes);
  for (unsigned distance = 1; distance < lanes; distance *= 2) s.add(exchanged(s, distance));
  if (exists && thread % lanes == 0) sum.take(i, s);
}

// See step/team.hpp. Each thread has one lane.
class LaneTeam {
 public:
  __device__ LaneTeam()
      : lane_(threadIdx.x % wall_lanes),
        first_(threadIdx.x % particles::WarpGroup::size - lane_),
        mask_(((1u << wall_lanes) - 1) << first_) {}
  template <class OfLane>
  __device__ auto sum(OfLane of_lane) const {
    const auto own = of_lane(lane_);
    __syncwarp(mask_);
    auto sum = value_of(own, first_, mask_);
    for (unsigned lane = 1; lane < wall_lanes; ++lane) sum.add(value_of(own, first_ + lane, mask_));
    return sum;
  }
  __device__ bool leads() const { return lane_ == 0; }

 private:
  std::uint32_t lane_, first_;  // in the warp: the first thread of the team
  unsigned mask_;               // of its threads
};

// Adds the tallies of a block up; thread 0 then has the sum. shared: one for each warp.
template <class Tally>
__device__ void add_up(Tally& own, Tally* shared) {
  constexpr unsigned warp = particles::WarpGroup::size;
  const auto over_warp = [](Tally& t) {
    for (unsigned distance = 1; distance < warp; distance *= 2) t.add(exchanged(t, distance));
  };
  over_warp(own);
  if (threadIdx.x % warp == 0) shared[threadIdx.x / warp] = own;
  __syncthreads();
  if (threadIdx.x >= warp) return;
  own = threadIdx.x < blockDim.x / warp ? shared[threadIdx.x] : Tally{};
  over_warp(own);
}

// Sums of bodies: those of few bodies are added up in the memory of a block first. A thread keeps what it
// adds until all threads of its warp settle together.
class DeviceBodySums {
 public:
  __device__ DeviceBodySums(particles::SplitSum* shared, std::uint32_t in_shared, std::int64_t* global)
      : shared_(shared), in_shared_(in_shared), global_(global) {}

  __device__ void add(std::uint32_t body, Vec3d acceleration, Vec3d torque, const Quanta& q) {
    BodySum sum;
    sum.add(acceleration, torque, q);
    add(body, sum);
  }
  __device__ void add(std::uint32_t body, const BodySum& sum) {
    int k = 0;
    while (k < kept_ && body_[k] != body) ++k;
    if (k == most_kept) return add_alone(body, sum);
    if (k == kept_) {
      body_[kept_] = body;
      sum_[kept_++] = {};
    }
    sum_[k].add(sum);
  }
  // Adds what the threads have kept. All threads of a warp call it together.
  __device__ void settle() {
    for (;;) {
      const unsigned waiting = __ballot_sync(~0u, kept_ > 0);
      if (waiting == 0) return;
      const std::uint32_t mine = kept_ > 0 ? body_[kept_ - 1] : 0,
                          body = __shfl_sync(~0u, mine, __ffs(static_cast<int>(waiting)) - 1);
      int k = 0;
      while (k < kept_ && body_[k] != body) ++k;
      const bool has = k < kept_;
      for (unsigned a = 0; a < 6; ++a) {
        const std::int64_t sum = particles::warp_sum(has ? component(sum_[k], a) : 0);
        if (threadIdx.x % particles::WarpGroup::size == 0) add_to(body, a, sum);
      }
      if (!has) continue;
      --kept_;
      body_[k] = body_[kept_];
      sum_[k] = sum_[kept_];
    }
  }

 private:
  static constexpr int most_kept = 4;

  __device__ static std::int64_t component(const BodySum& sum, unsigned a) {
    return a < 3 ? sum.acceleration[a] : sum.torque[a - 3];
  }
  __device__ void add_alone(std::uint32_t body, const BodySum& sum) {
    for (unsigned a = 0; a < 6; ++a) add_to(body, a, component(sum, a));
  }
  __device__ void add_to(std::uint32_t body, unsigned a, std::int64_t amount) {
    if (body < in_shared_)
      shared_[body * 6 + a].add(amount);
    else
      particles::add_global(global_ + std::size_t{body} * 6 + a, static_cast<unsigned long long>(amount));
  }

  particles::SplitSum* shared_;
  std::uint32_t in_shared_;  // bodies
  std::int64_t* global_;     // 6 per body
  int kept_ = 0;
  std::uint32_t body_[most_kept];
  BodySum sum_[most_kept];
};

inline constexpr unsigned reduce_threads = 128, most_reduce_blocks = 528, join_threads = 512;
inline constexpr std::uint32_t most_shared_bodies = 32;

template <class Tally, class F>
__global__ void __launch_bounds__(reduce_threads) reduce_kernel(std::uint32_t n, F f, Tally* of_block) {
  __shared__ alignas(Tally) unsigned char space[reduce_threads / particles::WarpGroup::size * sizeof(Tally)];
  Tally own;
  for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < n; i += gridDim.x * blockDim.x) f(i, own);
  add_up(own, reinterpret_cast<Tally*>(space));
  if (threadIdx.x == 0) of_block[blockIdx.x] = own;
}
// shared: of SumOver. With three blocks on a multiprocessor the sums beside walls have 168 registers.
template <bool shared_by_team, class Tally, class F>
__global__ void __launch_bounds__(reduce_threads, 3)
    reduce_with_bodies_kernel(std::uint32_t n, F f, Tally* of_block, std::uint32_t bodies,
                              std::int64_t* of_body) {
  __shared__ alignas(Tally) unsigned char space[reduce_threads / particles::WarpGroup::size * sizeof(Tally)];
  __shared__ particles::SplitSum shared[most_shared_bodies * 6];
  const std::uint32_t in_shared = bodies < most_shared_bodies ? bodies : most_shared_bodies;
  for (unsigned k = threadIdx.x; k < in_shared * 6; k += blockDim.x) shared[k] = {0, 0};
  __syncthreads();
  Tally own;
  DeviceBodySums sums{shared, in_shared, of_body};
  constexpr bool team = F::by_teams && shared_by_team;
  const std::uint32_t sharing = team ? wall_lanes : 1,
                      first = (blockIdx.x * blockDim.x + threadIdx.x) / sharing,
                      stride = gridDim.x * blockDim.x / sharing;
  for (std::uint32_t i = first; __any_sync(~0u, i < n); i += stride) {
    if (i < n) {
      if constexpr (team)
        f(i, LaneTeam{}, own, sums);
      else if constexpr (F::by_teams)
        f(i, OneThreadTeam{}, own, sums);
      else
        f(i, own, sums);
    }
    __syncwarp();
    sums.settle();
  }
  add_up(own, reinterpret_cast<Tally*>(space));
  if (threadIdx.x == 0) of_block[blockIdx.x] = own;
  for (unsigned k = threadIdx.x; k < in_shared * 6; k += blockDim.x)
    particles::add_global(of_body + k, shared[k].value());
}
template <class Tally>
__global__ void __launch_bounds__(join_threads) join_kernel(unsigned blocks, Tally* of_block) {
  __shared__ alignas(Tally) unsigned char space[join_threads / particles::WarpGroup::size * sizeof(Tally)];
  Tally own;
  for (unsigned k = threadIdx.x; k < blocks; k += blockDim.x) own.add(of_block[k]);
  add_up(own, reinterpret_cast<Tally*>(space));
  if (threadIdx.x == 0) of_block[0] = own;
}

// A second stream of work. It goes first where both wait for room on the device.
class Fork {
 public:
  Fork() {
    int least = 0, greatest = 0;
    particles::check_cuda(cudaDeviceGetStreamPriorityRange(&least, &greatest), "asking for priorities");
    particles::check_cuda(cudaStreamCreateWithPriority(&stream_, cudaStreamNonBlocking, greatest),
                          "opening a stream");
    particles::check_cuda(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "making an event");
  }
  ~Fork() {
    cudaEventDestroy(event_);
    cudaStreamDestroy(stream_);
  }
  Fork(const Fork&) = delete;
  Fork& operator=(const Fork&) = delete;

  void swap(cudaStream_t& other) { std::swap(stream_, other); }
  void leave(cudaStream_t from) { order(from, stream_); }
  void join(cudaStream_t to) { order(stream_, to); }

 private:
  void order(cudaStream_t first, cudaStream_t second) {
    particles::check_cuda(cudaEventRecord(event_, first), "marking work");
    particles::check_cuda(cudaStreamWaitEvent(second, event_), "ordering work");
  }
  cudaStream_t stream_ = nullptr;
  cudaEvent_t event_ = nullptr;
};

class CudaExec : public particles::DeviceExec {
 public:
  explicit CudaExec(unsigned) {}

  // Where they are many, the numbers are listed first, so that the threads of a warp all have work.
  template <class Where, class F>
  void for_each_where(std::uint32_t n, Where where, F f) {
    if (n == 0) return;
    const Chosen<Where> chosen = choose(n, where, 0);
    for_each_where_kernel<<<blocks(n, particles::block_threads), particles::block_threads, 0, stream_>>>(
        chosen, f);
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
  }
  // f of the numbers for which a(i) holds, and beside it g of those for which b(i) holds.
  template <class A, class F, class B, class G>
  void for_each_of_two(std::uint32_t n, A a, F f, B b, G g) {
    if (n == 0) return;
    const Chosen<A> of_a = choose(n, a, 0);
    const Chosen<B> of_b = choose(n, b, 1);
    for_each_of_two_kernel<<<2 * blocks(n, particles::block_threads), particles::block_threads, 0, stream_>>>(
        of_a, f, of_b, g);
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
  }

  // Neither work may use what the other one changes.
  template <class A, class B>
  void side_by_side(A a, B b) {
    fork_.leave(stream_);
    fork_.swap(stream_);
    a();
    fork_.swap(stream_);
    b();
    fork_.join(stream_);
  }

  template <class Entry, class Find>
  void build_list(std::uint32_t n, Find find, List<CudaExec, Entry>& list) {
    grow(list.start, std::size_t{n} + 1);
    if constexpr (Find::by_warps) {
      grow(list.end, std::max(n, 1u));
      while (!list_in_room(n, find, list)) list.entry.resize(list.total + list.total / 8);
    } else {
      zero(list.start, std::size_t{n} + 1);
      fill(n, CountEntries<Entry, Find>{find, list.start.data()});
      list.total = checked_total(reduce<EntryTotal>(n, AddCount{list.start.data()}).entries);
      exclusive_sum(list.start, n + 1);
      if (list.entry.size() < list.total) list.entry.resize(list.total + list.total / 8);
      fill(n, WriteEntries<Entry, Find>{find, list.start.data(), list.entry.data()});
    }
  }

  template <class Entry, class Keep>
  void keep_entries(std::uint32_t n, const std::uint32_t* particle, Keep keep, List<CudaExec, Entry>& list) {
    if (n == 0) return;
    const unsigned threads = block(particles::block_threads);
    keep_kernel<<<blocks(n * particles::WarpGroup::size, threads), threads, 0, stream_>>>(
        n, particle, keep, list.start.data(), list.end.data(), list.entry.data());
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
  }

  template <class Sum>
  void sum_over_lanes(std::uint32_t n, Sum sum) {
    if (n == 0) return;
    const unsigned threads = block(particles::block_threads);
    sum_over_lanes_kernel<<<blocks(n * lanes, threads), threads, 0, stream_>>>(n, sum);
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
  }

  template <class Tally, class F>
  Tally reduce(std::uint32_t n, F f) {
    Tally* const of_block = tallies<Tally>();
    reduce_kernel<<<reduce_blocks(n), reduce_threads, 0, stream_>>>(n, f, of_block);
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
    return joined(n, of_block);
  }
  template <class Tally, class... F>
  Tally reduce(std::vector<BodySum>& of_bodies, SumOver<F>... parts) {
    static_assert(sizeof(BodySum) == 6 * sizeof(std::int64_t));
    Tally* const of_block = tallies<Tally>(sizeof...(parts));
    grow(of_body_, std::max<std::size_t>(1, of_bodies.size()) * 6);
    zero(of_body_, of_bodies.size() * 6);
    unsigned blocks = 0;
    const auto start = [&]<bool shared_by_team>(const auto& part) {
      const unsigned of_part = reduce_blocks(part.n * (shared_by_team ? wall_lanes : 1));
      reduce_with_bodies_kernel<shared_by_team><<<of_part, reduce_threads, 0, stream_>>>(
          part.n, part.f, of_block + blocks, static_cast<std::uint32_t>(of_bodies.size()), of_body_.data());
      particles::check_cuda(cudaGetLastError(), "starting a kernel");
      blocks += of_part;
    };
    const auto add = [&](const auto& part) {
      if (part.n == 0) return;
      if constexpr (std::decay_t<decltype(part.f)>::by_teams) {
        if (part.shared) return start.template operator()<true>(part);
      }
      start.template operator()<false>(part);
    };
    (add(parts), ...);
    join(blocks, of_block);
    Tally sum;
    download(tallies_, std::as_writable_bytes(std::span(&sum, 1)), of_body_,
             std::span(reinterpret_cast<std::int64_t*>(of_bodies.data()), of_bodies.size() * 6));
    return sum;
  }

 private:
  // which: of the lists in `chosen_`.
  template <class Where>
  Chosen<Where> choose(std::uint32_t n, Where where, int which) {
    constexpr std::uint32_t many = 1u << 17;
    grow(chosen_count_, 2);
    std::uint32_t* const count = chosen_count_.data() + which;
    if (n < many) return {n, where, nullptr, count};
    grow(chosen_[which], n);
    with_scratch([&](void* scratch, std::size_t& bytes) {
      return cub::DeviceSelect::If(scratch, bytes, thrust::counting_iterator<std::uint32_t>(0),
                                   chosen_[which].data(), count, static_cast<std::int64_t>(n), where,
                                   stream_);
    });
    return {n, where, chosen_[which].data(), count};
  }
  // False if there is too little room for the entries; it then knows how many there are.
  template <class Entry, class Find>
  bool list_in_room(std::uint32_t n, Find find, List<CudaExec, Entry>& list) {
    if (list_total_.size() == 0) list_total_.resize(1);
    zero(list_total_, 1);
    const auto room = static_cast<std::uint32_t>(
        std::min<std::size_t>(list.entry.size(), std::numeric_limits<std::uint32_t>::max()));
    if (n > 0) {
      list_kernel<<<(n + list_warps - 1) / list_warps, list_warps * particles::WarpGroup::size, 0, stream_>>>(
          n, find, list.start.data(), list.end.data(), list.entry.data(), room, list_total_.data());
      particles::check_cuda(cudaGetLastError(), "starting a kernel");
    }
    unsigned long long total = 0;
    download(list_total_, std::span(&total, 1));
    list.total = checked_total(total);
    return list.total <= room;
  }
  template <class F>
  void fill(std::uint32_t n, F f) {
    if (n == 0) return;
    const unsigned threads = block(particles::block_threads);
    particles::for_each_alone_kernel<<<blocks(n, threads), threads, 0, stream_>>>(n, f);
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
  }
  static unsigned reduce_blocks(std::uint32_t n) {
    return std::min(most_reduce_blocks, blocks(n, reduce_threads));
  }
  template <class Tally>
  Tally* tallies(std::size_t parts = 1) {
    static_assert(alignof(Tally) <= 16);
    grow(tallies_, parts * most_reduce_blocks * sizeof(Tally));
    return reinterpret_cast<Tally*>(tallies_.data());
  }
  template <class Tally>
  void join(unsigned blocks, Tally* of_block) {
    join_kernel<<<1, join_threads, 0, stream_>>>(blocks, of_block);
    particles::check_cuda(cudaGetLastError(), "starting a kernel");
  }
  template <class Tally>
  Tally joined(std::uint32_t n, Tally* of_block) {
    join(reduce_blocks(n), of_block);
    Tally sum;
    download(tallies_, std::as_writable_bytes(std::span(&sum, 1)));
    return sum;
  }

  Fork fork_;
  Buffer<std::uint32_t> chosen_[2], chosen_count_;  // see choose()
  Buffer<std::byte> tallies_;                       // of the blocks of a kernel
  Buffer<std::int64_t> of_body_;
  Buffer<unsigned long long> list_total_;
};

}  // namespace tandem::sph
