// The kernels by which the ranks of a host send each other the state of ghosts and a report of each micro
// step, see rank_exchange.cuh.
//
// A message has a number, and memory for two: a rank that has got message s of all others may send s + 1
// while these still read s, but it sends s + 2 only when it has got their s + 1, which follows their s.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cstdint>

#include "dem_server/contact/ghosts.hpp"
#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/range.hpp"

namespace tandem::dem {

// What a rank reports of a step; `number` is written last.
struct alignas(16) RankReport {
  std::uint32_t number = 0, max_speed2 = 0, error = 0, culprit = ~0u;
};

template <class Real, bool with_spin>
struct RankMessages {
  using Ghost = GhostState<Real, with_spin>;
  struct Outgoing {
    Range part;    // of `send`
    Ghost* to[2];  // where the receiver has them, for even and odd messages
  };
  struct Incoming {
    Range ghosts;  // indices
    const Ghost* from[2];
  };
  const Outgoing* outgoing = nullptr;
  const Incoming* incoming = nullptr;
  std::uint32_t sent = 0, ghosts = 0;
  const std::uint32_t* send = nullptr;
  std::uint32_t ranks = 0;
  RankReport* const* report_to[2]{};  // of each rank: where it has the report of this one
  RankReport* reports[2]{};           // of all ranks
  std::uint32_t* number = nullptr;    // of the last message, then the number of blocks that have sent
};

// The state of the ghosts that others have, and a report of the step. `gate`: progress of the step, which may
// not have begun; null: there was none, and the state is that of `side`.
template <class Real, bool with_spin>
__global__ void send_kernel(const __grid_constant__ View<Real> view, RankMessages<Real, with_spin> messages,
                            const StepProgress* gate, unsigned step_side, std::uint32_t side) {
  if (gate != nullptr) {
    if (gate->open == 0) return;
    side = gate->state_side ^ 1;
  }
  const std::uint32_t number = messages.number[0] + 1, which = number & 1;
  std::uint32_t link = 0;
  for (std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x; k < messages.sent;
       k += gridDim.x * blockDim.x) {
    while (k >= messages.outgoing[link].part.end) ++link;
    const auto& to = messages.outgoing[link];
    to.to[which][k - to.part.begin] = GhostState<Real, with_spin>::of(view.spheres, side, messages.send[k]);
  }
  __threadfence_system();
  __syncthreads();
  __shared__ bool is_last;
  if (threadIdx.x == 0) is_last = atomicAdd(messages.number + 1, 1u) + 1 == gridDim.x;
  __syncthreads();
  if (!is_last) return;
  __threadfence_system();
  const WindowProgress& window = *view.window;
  for (std::uint32_t rank = threadIdx.x; rank < messages.ranks; rank += blockDim.x) {
    volatile RankReport& report = *messages.report_to[which][rank];
    report.max_speed2 = __float_as_uint(window.max_speed2[step_side ^ 1]);
    report.error = window.error;
    report.culprit = window.culprit;
    __threadfence_system();
    report.number = number;
  }
  if (threadIdx.x == 0) messages.number[0] = number, messages.number[1] = 0;
}

// Waits for the messages of all ranks, and gives the ghosts here the state in them.
inline constexpr std::uint64_t longest_wait = 60'000'000'000;  // [ns]
__device__ inline std::uint64_t nanoseconds() {
  std::uint64_t now;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(now));
  return now;
}
template <class Real, bool with_spin>
__global__ void receive_kernel(const __grid_constant__ View<Real> view,
                               RankMessages<Real, with_spin> messages, const StepProgress* gate,
                               unsigned step_side, std::uint32_t side) {
  if (gate != nullptr) {
    if (gate->open == 0) return;
    side = gate->state_side ^ 1;
  }
  WindowProgress& window = *view.window;
  const std::uint32_t number = messages.number[0], which = number & 1;
  for (std::uint32_t rank = threadIdx.x; rank < messages.ranks; rank += blockDim.x) {
    const volatile std::uint32_t& arrived = messages.reports[which][rank].number;
    for (const std::uint64_t begin = nanoseconds(); arrived != number;)
      if (nanoseconds() - begin > longest_wait) {
        atomicOr(&window.error, static_cast<unsigned>(ranks_apart));
        break;
      }
  }
  __syncthreads();
  __threadfence_system();
  std::uint32_t link = 0, before = 0;
  for (std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x; k < messages.ghosts;
       k += gridDim.x * blockDim.x) {
    const auto count = [&] {
      return messages.incoming[link].ghosts.end - messages.incoming[link].ghosts.begin;
    };
    for (; k >= before + count(); ++link) before += count();
    const auto& from = messages.incoming[link];
    using Ghost = GhostState<Real, with_spin>;
    static_assert(sizeof(Ghost) % sizeof(int4) == 0);
    Ghost ghost;
    for (std::size_t part = 0; part < sizeof(Ghost) / sizeof(int4); ++part)
      reinterpret_cast<int4*>(&ghost)[part] =
          __ldcg(reinterpret_cast<const int4*>(from.from[which] + (k - before)) + part);
    ghost.store(view.spheres, side, from.ghosts.begin + (k - before));
  }
  if (gate == nullptr || blockIdx.x != 0 || threadIdx.x != 0) return;
  // The next rebuild depends on the largest speed.
  unsigned fastest = __float_as_uint(window.max_speed2[step_side ^ 1]);
  for (std::uint32_t rank = 0; rank < messages.ranks; ++rank) {
    const volatile RankReport& report = messages.reports[which][rank];
    fastest = max(fastest, static_cast<unsigned>(report.max_speed2));
    if (report.error == 0) continue;
    atomicOr(&window.error, static_cast<unsigned>(report.error));
    window.step_error[step_side ^ 1] |= report.error;
    window.culprit = min(window.culprit, static_cast<std::uint32_t>(report.culprit));
  }
  window.max_speed2[step_side ^ 1] = __uint_as_float(fastest);
}

}  // namespace tandem::dem
