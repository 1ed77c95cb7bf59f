#include "dem_server/backend/cuda/exec_cuda.cuh"

#include "particles/backend/setting.hpp"

namespace tandem::dem {

namespace {

__global__ void decide_rebuild_kernel(const WindowProgress* window, cudaGraphConditionalHandle rebuild) {
  cudaGraphSetConditional(
      rebuild, window->progress[0].rebuild_due != 0 && window->progress[0].step < window->steps ? 1 : 0);
}

__global__ void decide_round_kernel(WindowProgress* window, cudaGraphConditionalHandle another_round) {
  StepProgress& progress = window->progress[0];
  close_step(*window, 0, progress);
  cudaGraphSetConditional(another_round, progress.step < window->steps && window->error == 0 ? 1 : 0);
}

__global__ void close_round_kernel(WindowProgress* window) {
  close_step(*window, 0, window->progress[0]);
}

// Adds a conditional node to `graph` and returns the graph that it guards.
cudaGraph_t add_conditional(cudaGraph_t graph, cudaGraphConditionalHandle handle,
                            cudaGraphConditionalNodeType type, const cudaGraphNode_t* after,
                            cudaGraphNode_t* node) {
  cudaGraphNodeParams parameters{};
  parameters.type = cudaGraphNodeTypeConditional;
  parameters.conditional.handle = handle;
  parameters.conditional.type = type;
  parameters.conditional.size = 1;
  check_cuda(cudaGraphAddNode(node, graph, after, nullptr, after == nullptr ? 0 : 1, &parameters),
             "building the window's graph");
  return parameters.conditional.phGraph_out[0];
}

}  // namespace

CudaExec::CudaExec() {
  plain_launches_ = setting("TANDEM_CUDA_GRAPHS") == 0u;
  most_regions_ = setting("TANDEM_CUDA_REGIONS").value_or(most_regions_);
  if (const auto lanes = setting("TANDEM_CUDA_LANES")) few_spheres_ = *lanes == 1 ? 0 : ~0u;
  check_cuda(cudaStreamCreateWithFlags(&second_stream_, cudaStreamNonBlocking), "opening a stream");
  check_cuda(cudaEventCreateWithFlags(&reached_, cudaEventDisableTiming), "making an event");
  int device = 0, major = 0;
  check_cuda(cudaGetDevice(&device), "asking for the device");
  check_cuda(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device),
             "asking for the device's capability");
  overlaps_ = major >= 9;
}

CudaExec::~CudaExec() {
  forget_captured();
  if (reached_ != nullptr) cudaEventDestroy(reached_);
  if (second_stream_ != nullptr) cudaStreamDestroy(second_stream_);
}

CudaExec::CudaExec(CudaExec&& other) noexcept
    : DeviceExec(std::move(other)),
      second_stream_(std::exchange(other.second_stream_, nullptr)),
      reached_(std::exchange(other.reached_, nullptr)),
      executable_(std::exchange(other.executable_, nullptr)),
      most_regions_(other.most_regions_),
      roomy_regions_(other.roomy_regions_),
      few_spheres_(other.few_spheres_),
      overlaps_(other.overlaps_),
      plain_launches_(other.plain_launches_) {}

void CudaExec::order(cudaStream_t sooner, cudaStream_t later) {
  check_cuda(cudaEventRecord(reached_, sooner), "marking work");
  check_cuda(cudaStreamWaitEvent(later, reached_), "ordering work");
}

void CudaExec::forget_captured() {
  if (executable_ != nullptr) cudaGraphExecDestroy(executable_);
  executable_ = nullptr;
}

void CudaExec::prepare_regions(std::uint32_t n, std::size_t entries) {
  regions_ = {};
  int device = 0, multiprocessors = 0, shared = 0, together = 0;
  check_cuda(cudaGetDevice(&device), "asking for the device");
  const auto read_attribute = [&](int& value, cudaDeviceAttr what) {
    check_cuda(cudaDeviceGetAttribute(&value, what, device), "asking for the device's size");
  };
  read_attribute(multiprocessors, cudaDevAttrMultiProcessorCount);
  read_attribute(shared, cudaDevAttrMaxSharedMemoryPerBlockOptin);
  read_attribute(together, cudaDevAttrCooperativeLaunch);
  const std::uint32_t most = static_cast<std::uint32_t>(multiprocessors);
  if (together == 0 || most_regions_ == 0 || n > std::min(most, most_regions_) * resident_mean ||
      n > resident_threads * resident_threads)  // region_begin()
    return;
  regions_.count = std::min(std::clamp<std::uint32_t>(n / resident_least, 1, most), most_regions_);
  // The L1 cache gets the part of shared memory that regions leave. The first attempt therefore takes only
  // what a usual bed needs, and more where spheres are few, since their regions differ more in size.
  const std::size_t most_space = static_cast<std::size_t>(shared) - resident_static_space,
                    mean = n / regions_.count, usual = 440 * mean + 16384,
                    loose = std::min<std::size_t>(704 * mean + 16384, 192 * 1024);
  regions_.space = roomy_regions_ ? most_space : std::min(most_space, std::max(usual, loose));
  region_.resize(regions_.count);
  work_.resize(n + 1);
  halo_.resize(std::size_t{regions_.count} * resident_halo);
  neighbour_.resize(entries);
  barrier_.resize(1);
  regions_.region = region_.data();
  regions_.halo = halo_.data();
  regions_.neighbour = neighbour_.data();
  regions_.barrier = barrier_.data();
}

CudaExec::WindowGraph CudaExec::begin_graph(const WindowProgress* window) {
  WindowGraph g;
  check_cuda(cudaGraphCreate(&g.whole, 0), "creating the window's graph");
  check_cuda(cudaGraphConditionalHandleCreate(&g.another_round, g.whole, 1, cudaGraphCondAssignDefault),
             "creating the window's loop");
  cudaGraphNode_t loop = nullptr;
  g.round = add_conditional(g.whole, g.another_round, cudaGraphCondTypeWhile, nullptr, &loop);

  cudaGraphConditionalHandle rebuild{};
  check_cuda(cudaGraphConditionalHandleCreate(&rebuild, g.round, 0, cudaGraphCondAssignDefault),
             "creating the rebuild's condition");
  begin_capture(g.round, nullptr);
  decide_rebuild_kernel<<<1, 1, 0, stream_>>>(window, rebuild);
  end_capture();
  cudaGraphNode_t decide = nullptr;
  std::size_t nodes = 1;
  check_cuda(cudaGraphGetNodes(g.round, &decide, &nodes), "reading the window's graph");
  g.rebuild = add_conditional(g.round, rebuild, cudaGraphCondTypeIf, &decide, &g.rebuild_node);
  return g;
}

void CudaExec::begin_capture(cudaGraph_t into, const cudaGraphNode_t* after) {
  check_cuda(cudaStreamBeginCaptureToGraph(stream_, into, after, nullptr, after == nullptr ? 0 : 1,
                                           cudaStreamCaptureModeThreadLocal),
             "capturing the window");
}

void CudaExec::decide_round(WindowProgress* window, cudaGraphConditionalHandle another_round) {
  decide_round_kernel<<<1, 1, 0, stream_>>>(window, another_round);
}

void CudaExec::close_round(WindowProgress* window) {
  close_round_kernel<<<1, 1, 0, stream_>>>(window);
  check_cuda(cudaGetLastError(), "starting a kernel");
}

void CudaExec::end_capture() {
  cudaGraph_t captured = nullptr;
  check_cuda(cudaStreamEndCapture(stream_, &captured), "capturing the window");
}

void CudaExec::finish_graph(WindowGraph& graph) {
  check_cuda(cudaGraphInstantiate(&executable_, graph.whole, 0), "preparing the window's graph");
  cudaGraphDestroy(graph.whole);
}

}  // namespace tandem::dem
