// The CUDA back end (backend/concept.hpp): device memory, a stream, and a second stream for concurrent work.
//
// A window is one CUDA graph with conditional nodes, so that no step waits for the host:
//
//   WHILE steps are left {
//     decide ─► IF a rebuild is due { rebuild } ─► { walls ┄► step } x steps_per_round ─► decide
//   }
//
// A step that finds a rebuild due, or the window done, returns at once, and the next round of the loop
// continues from there. No kernel waits for the bookkeeping of a step: the next kernel closes that step
// (particles/state/window_progress.hpp). The dotted arrow is a programmatic dependency: the step kernel sums
// the forces between spheres while the wall kernel still runs, and waits for the wall forces before it moves
// spheres near walls.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "dem_server/backend/concept.hpp"
#include "dem_server/backend/cuda/block_tally.cuh"
#include "dem_server/backend/cuda/fill_lists.cuh"
#include "dem_server/backend/cuda/rank_exchange.cuh"
#include "dem_server/backend/cuda/resident/resident.cuh"
#include "dem_server/backend/cuda/streaming/step_kernels.cuh"
#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/cuda/device_exec.cuh"
#include "particles/backend/cuda/warp_group.cuh"
#include "particles/base/check_cuda.cuh"
#include "particles/base/fixed_point.hpp"
#include "particles/geometry/facet_contact.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

// The totals of one thread.
template <unsigned totals>
struct TotalsTally {
  std::int64_t sum[totals]{};

  __device__ void add_total(int which, std::int64_t amount) { sum[which] += amount; }
};

// Atomics on one address are serialised: each block issues one, and there are few blocks.
inline constexpr unsigned most_account_blocks = 1056;
template <unsigned totals, class Record>
__global__ void account_kernel(std::uint32_t n, Record record) {
  static_assert(totals <= block_threads);
  __shared__ SplitSum of_block[totals];
  if (threadIdx.x < totals) of_block[threadIdx.x] = {0, 0};
  __syncthreads();
  TotalsTally<totals> tally;
  for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < n; i += gridDim.x * blockDim.x)
    record(i, tally);
  __syncwarp();
#pragma unroll
  for (unsigned b = 0; b < totals; ++b) {
    const std::int64_t of_warp = warp_sum(tally.sum[b]);
    if ((threadIdx.x & 31) == 0) of_block[b].add(of_warp);
  }
  __syncthreads();
  if (threadIdx.x < totals) add_global(record.view.totals + threadIdx.x, of_block[threadIdx.x].value());
}

class CudaExec : public DeviceExec {
 public:
  template <class Real, bool with_spin>
  using RankExchange = CudaRankExchange<Real, with_spin>;

  CudaExec();
  ~CudaExec();
  CudaExec(CudaExec&& other) noexcept;

  // A graph cannot wait for the host, and regions do not know of ghosts.
  void let_host_rebuild() {
    plain_launches_ = true;
    most_regions_ = 0;
  }
  cudaStream_t stream() const { return stream_; }
  // Of the step that is being started, see WindowProgress.
  unsigned step_side() const { return step_ & 1u; }

  // One warp per iteration where n is small, which has the lower latency; else one thread, which is less
  // work.
  template <class F>
  void for_each_shared(std::uint32_t n, F f) {
    if (n < few_spheres_) return for_each_by_warps(n, f);
    if (sizing_ || n == 0) return;
    for_each_alone_kernel<<<blocks(n, block(block_threads)), block(block_threads), 0, stream_>>>(n, f);
    check_cuda(cudaGetLastError(), "starting a kernel");
  }
  template <class Fill>
  void fill_lists(std::uint32_t n, Fill fill) {
    if (n < few_spheres_) return for_each_by_warps(n, fill);
    if (sizing_ || n == 0) return;
    fill_lists_kernel<<<blocks(n, block(fill_threads)), block(fill_threads), 0, stream_>>>(n, fill);
    check_cuda(cudaGetLastError(), "starting a kernel");
  }
  template <class First, class Second>
  void at_once(First first, Second second) {
    order(stream_, second_stream_);
    std::swap(stream_, second_stream_);
    first();
    std::swap(stream_, second_stream_);
    second();
    order(second_stream_, stream_);
  }
  template <class Step>
  void step(std::uint32_t n, const Step& step, std::uint32_t rows) {
    if (regions_.count > 0) return steps_in_regions(step, rows);
    const unsigned side = step_ & 1u;
    const unsigned wall_threads = block(wall_block_threads),
                   wall_blocks = std::min(largest_wall_blocks, blocks(n, wall_threads));
    // The first step of a round follows work that does not trigger programmatic dependencies.
    launch(wall_blocks, wall_threads, step_ > 0, wall_kernel<Step>, step, rows, side);
    const Range owned = step.view.spheres.owned;
    step.view.grid.levels > 1 ? launch_step<Levels::many>(owned.end - owned.begin, step, rows, side)
                              : launch_step<Levels::one>(owned.end - owned.begin, step, rows, side);
  }
  template <unsigned totals, class Record>
  void account(std::uint32_t n, const Record& record) {
    account_kernel<totals>
        <<<std::min(most_account_blocks, blocks(n, block_threads)), block_threads, 0, stream_>>>(n, record);
    check_cuda(cudaGetLastError(), "starting the accounts");
  }

  // Divides the lists among the regions.
  template <class Real>
  void prepare_lists(const View<Real>& view) {
    if (regions_.count == 0) return;
    for_each(view.spheres.count + 1, WeighSphere<Real>{view, work_.data()});
    exclusive_sum(work_, view.spheres.count + 1);
    if (sizing_) return;
    divide_kernel<<<regions_.count, resident_threads, 0, stream_>>>(view, work_.data(), regions_);
    check_cuda(cudaGetLastError(), "starting a kernel");
  }

  template <class Real, class Rebuild, class Step>
  void run_window(const View<Real>& view, Buffer<WindowProgress>& window, Rebuild rebuild, Step step) {
    if (executable_ == nullptr) {  // lists may have grown, or have been restored or read
      prepare_regions(view.spheres.count, view.lists.pair_capacity);
      prepare_lists(view);
    }
    if (plain_launches_) return run_plainly(window, rebuild, step);
    if (executable_ == nullptr) {
      // Nothing can be allocated while a graph is captured, so that a dry run first determines how much
      // scratch memory CUB needs.
      sizing_ = true;
      rebuild();
      sizing_ = false;
      WindowGraph graph = begin_graph(window.data());
      begin_capture(graph.rebuild, nullptr);
      rebuild();
      end_capture();
      begin_capture(graph.round, &graph.rebuild_node);
      for (step_ = 0; step_ < (regions_.count > 0 ? 1 : steps_per_round); ++step_) step();
      decide_round(window.data(), graph.another_round);
      end_capture();
      finish_graph(graph);
    }
    check_cuda(cudaGraphLaunch(executable_, stream_), "starting a window");
  }
  // The same without a graph: for ranks, and because compute-sanitizer's racecheck and ncu cannot inspect
  // kernels of graphs.
  template <class Rebuild, class Step>
  void run_plainly(Buffer<WindowProgress>& window, Rebuild rebuild, Step step) {
    WindowProgress c;
    for (;;) {
      download(window, std::span<WindowProgress>(&c, 1));
      if (c.progress[0].step >= c.steps || c.error != 0) return;
      if (c.progress[0].rebuild_due != 0) rebuild();
      for (step_ = 0; step_ == 0 || (step_ < steps_per_round && regions_.count == 0); ++step_) step();
      close_round(window.data());
    }
  }
  void forget_captured();
  // To be called when a region does not fit: gives regions more room, or does without them from now on.
  void enlarge_regions() {
    if (roomy_regions_) most_regions_ = 0;
    roomy_regions_ = true;
    forget_captured();
  }
  std::uint32_t regions() const { return regions_.count; }
  unsigned threads() const { return 1; }

 private:
  // A shorter round wastes fewer idle steps at a rebuild, a longer one has less overhead of the loop. The
  // number must be even, see WindowProgress.
  static constexpr unsigned steps_per_round = 16;

  struct WindowGraph {
    cudaGraph_t whole = nullptr, round = nullptr, rebuild = nullptr;
    cudaGraphConditionalHandle another_round{};
    cudaGraphNode_t rebuild_node = nullptr;
  };
  WindowGraph begin_graph(const WindowProgress* window);
  void begin_capture(cudaGraph_t into, const cudaGraphNode_t* after);
  void decide_round(WindowProgress* window, cudaGraphConditionalHandle another_round);
  void end_capture();
  void close_round(WindowProgress* window);
  void finish_graph(WindowGraph& graph);

  template <class F>
  void for_each_by_warps(std::uint32_t n, F f) {
    if (sizing_ || n == 0) return;
    for_each_shared_kernel<<<blocks(n * WarpGroup::size, block(block_threads)), block(block_threads), 0,
                             stream_>>>(n, f);
    check_cuda(cudaGetLastError(), "starting a kernel");
  }

  template <Levels levels, class Step>
  void launch_step(std::uint32_t n, const Step& step, std::uint32_t rows, unsigned side) {
    const bool few = n < few_spheres_;
    const unsigned threads = block(step_block_threads);
    launch(blocks(few ? n * 2 : n, threads), threads, true,
           few ? step_kernel<Step, 2, levels> : step_kernel<Step, 1, levels>, step, rows, side);
  }
  // `early`: the kernel may start before the previous one has ended.
  template <class... Parameters, class... Arguments>
  void launch(unsigned grid, unsigned block, bool early, void (*kernel)(Parameters...),
              const Arguments&... arguments) {
    cudaLaunchAttribute attribute{};
    attribute.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    attribute.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(grid);
    config.blockDim = dim3(block);
    config.stream = stream_;
    config.attrs = &attribute;
    config.numAttrs = early && overlaps_ ? 1 : 0;
    check_cuda(cudaLaunchKernelEx(&config, kernel, Parameters(arguments)...), "starting a kernel");
  }

  // Allocates regions where the spheres may fit into shared memory.
  void prepare_regions(std::uint32_t n, std::size_t entries);
  template <class Step>
  void steps_in_regions(const Step& step, std::uint32_t rows) {
    const auto space = static_cast<int>(regions_.space);
    const auto kernel =
        step.view.grid.levels > 1 ? resident_kernel<Step, Levels::many> : resident_kernel<Step, Levels::one>;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, space),
               "asking for shared memory");
    zero(barrier_, 1);
    // Blocks wait for each other, so that all of them must run at the same time.
    cudaLaunchAttribute attribute{};
    attribute.id = cudaLaunchAttributeCooperative;
    attribute.val.cooperative = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(regions_.count);
    config.blockDim = dim3(resident_threads);
    config.dynamicSmemBytes = regions_.space;
    config.stream = stream_;
    config.attrs = &attribute;
    config.numAttrs = 1;
    check_cuda(cudaLaunchKernelEx(&config, kernel, step, regions_, rows), "starting a kernel");
  }

  // Work that is added to `later` from now on waits for the present work of `sooner`.
  void order(cudaStream_t sooner, cudaStream_t later);
  void moved_scratch() override { forget_captured(); }

  cudaStream_t second_stream_ = nullptr;
  cudaEvent_t reached_ = nullptr;  // recorded by a stream that another one waits for
  cudaGraphExec_t executable_ = nullptr;
  Regions regions_;  // count 0: steps go through memory
  Buffer<RegionEntries> region_;
  Buffer<std::uint32_t> work_;  // of each sphere, then summed over all lower indices (n + 1)
  Buffer<std::uint32_t> halo_;
  Buffer<std::uint16_t> neighbour_;
  Buffer<GridBarrier> barrier_;
  std::uint32_t most_regions_ = ~0u;  // TANDEM_CUDA_REGIONS; 0: no regions
  bool roomy_regions_ = false;
  // Below this count two threads process each sphere in a step, and a warp processes it in a rebuild; from
  // this count on it is one thread. TANDEM_CUDA_LANES overrides it.
  std::uint32_t few_spheres_ = 250'000;
  bool overlaps_ = false;        // the device supports programmatic dependencies
  bool plain_launches_ = false;  // TANDEM_CUDA_GRAPHS=0
  unsigned step_ = 0;            // number of the step within the round
};

static_assert(BackEnd<CudaExec>);

}  // namespace tandem::dem
