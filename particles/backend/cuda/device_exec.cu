#include "particles/backend/cuda/device_exec.cuh"

#include <cstring>
#include <string>

#include "particles/backend/setting.hpp"

namespace tandem::particles {

DeviceExec::DeviceExec() {
  if (const auto threads = setting("TANDEM_CUDA_BLOCK")) {
    if (*threads == 0 || *threads % 32 != 0)
      throw Error(ErrorCode::usage, "no block has " + std::to_string(*threads) + " threads",
                  "TANDEM_CUDA_BLOCK", "say a multiple of 32");
    most_block_threads_ = *threads;
  }
  check_cuda(cudaGetDevice(&device_), "asking for the device");
  check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "opening a stream");
  check_cuda(cudaStreamCreateWithFlags(&aside_, cudaStreamNonBlocking), "opening a stream");
  check_cuda(cudaEventCreateWithFlags(&marked_, cudaEventDisableTiming), "making an event");
  check_cuda(cudaMallocHost(&landing_, landing_bytes), "allocating memory for copies from the device");
  check_cuda(cudaMallocHost(&departure_, departure_bytes), "allocating memory for copies to the device");
}

DeviceExec::~DeviceExec() {
  cudaFreeHost(departure_);
  cudaFreeHost(landing_);
  if (marked_ != nullptr) cudaEventDestroy(marked_);
  if (aside_ != nullptr) cudaStreamDestroy(aside_);
  if (stream_ != nullptr) cudaStreamDestroy(stream_);
}

DeviceExec::DeviceExec(DeviceExec&& other) noexcept
    : stream_(std::exchange(other.stream_, nullptr)),
      sizing_(other.sizing_),
      most_block_threads_(other.most_block_threads_),
      aside_(std::exchange(other.aside_, nullptr)),
      marked_(std::exchange(other.marked_, nullptr)),
      device_(other.device_),
      landing_(std::exchange(other.landing_, nullptr)),
      departure_(std::exchange(other.departure_, nullptr)),
      scratch_(std::move(other.scratch_)) {}

// Returns the place from which `bytes` are copied to the device; `from` may change after the call.
const void* DeviceExec::staged(const void* from, std::size_t bytes) {
  constexpr std::size_t alignment = 16;
  const std::size_t room = (bytes + alignment - 1) / alignment * alignment;
  if (bytes == 0 || departed_ + room > departure_bytes) return from;
  std::byte* const place = departure_ + departed_;
  std::memcpy(place, from, bytes);
  departed_ += room;
  return place;
}

void DeviceExec::begin_download(const void* from, void* to, std::size_t bytes) {
  void* target = to;
  if (landed_ + bytes <= landing_bytes) {
    target = landing_ + landed_;
    downloads_.push_back({to, landed_, bytes});
    landed_ += bytes;
  }
  check_cuda(cudaMemcpyAsync(target, from, bytes, cudaMemcpyDeviceToHost, stream_),
             "copying from the device");
}

void DeviceExec::finish_downloads() {
  const std::vector<Download> landing = std::exchange(downloads_, {});
  landed_ = 0;
  check_cuda(cudaStreamSynchronize(stream_), "waiting for the device");
  departed_ = 0;
  for (const Download& d : landing) std::memcpy(d.to, landing_ + d.at, d.bytes);
}

void DeviceExec::mark() {
  check_cuda(cudaEventRecord(marked_, stream_), "marking work");
}

// The calling thread has to choose the device, and must not be disturbed by a capture in the other thread.
void DeviceExec::copy_marked(const void* from, void* to, std::size_t bytes) {
  check_cuda(cudaSetDevice(device_), "choosing the device");
  cudaStreamCaptureMode mode = cudaStreamCaptureModeRelaxed;
  check_cuda(cudaThreadExchangeStreamCaptureMode(&mode), "allowing copies beside a capture");
  check_cuda(cudaStreamWaitEvent(aside_, marked_), "ordering work");
  check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, aside_), "copying from the device");
  check_cuda(cudaStreamSynchronize(aside_), "waiting for the device");
  check_cuda(cudaThreadExchangeStreamCaptureMode(&mode), "allowing copies beside a capture");
}

}  // namespace tandem::particles
