// Device memory and a stream: what the CUDA back end of every particle solver offers, see
// dem_server/backend/concept.hpp.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cub/device/device_scan.cuh>
#include <span>
#include <utility>
#include <vector>

#include "particles/backend/cuda/cell_sort.cuh"
#include "particles/backend/traits.hpp"
#include "particles/base/check_cuda.cuh"

namespace tandem::particles {

inline constexpr unsigned block_threads = 128;

template <class F>
__global__ void for_each_kernel(std::uint32_t n, F f) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < n) f(i);
}

struct Plus {
  template <class T>
  __device__ T operator()(const T& a, const T& b) const {
    return a + b;
  }
};

class DeviceExec : public CudaTraits {
 public:
  template <class T>
  class Buffer {
   public:
    Buffer() = default;
    ~Buffer() { cudaFree(data_); }
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
      swap(other);
      return *this;
    }
    // Contents become zero: a copy of a buffer includes its spare room, which must not be uninitialised.
    void resize(std::size_t n) {
      if (n == size_) return;
      Buffer fresh;
      if (n > 0) {
        check_cuda(cudaMalloc(&fresh.data_, n * sizeof(T)), "allocating device memory");
        check_cuda(cudaMemset(fresh.data_, 0, n * sizeof(T)), "clearing device memory");
        check_cuda(cudaDeviceSynchronize(),
                   "clearing device memory");  // stream_ does not wait for other streams
      }
      fresh.size_ = n;
      swap(fresh);
    }
    T* data() { return data_; }
    const T* data() const { return data_; }
    std::size_t size() const { return size_; }

   private:
    void swap(Buffer& other) {
      std::swap(data_, other.data_);
      std::swap(size_, other.size_);
    }
    T* data_ = nullptr;
    std::size_t size_ = 0;
  };

  DeviceExec();
  virtual ~DeviceExec();
  DeviceExec(DeviceExec&& other) noexcept;
  DeviceExec& operator=(DeviceExec&&) = delete;

  template <class T>
  void upload(Buffer<T>& to, std::span<const T> from) {
    if (to.size() < from.size()) to.resize(from.size());
    check_cuda(cudaMemcpyAsync(to.data(), staged(from.data(), from.size_bytes()), from.size_bytes(),
                               cudaMemcpyHostToDevice, stream_),
               "copying to the device");
  }
  // One or more buffers, with one synchronisation for all of them.
  template <class T, class... More>
  void download(const Buffer<T>& from, std::span<T> to, const More&... more) {
    begin_download(from.data(), to.data(), to.size_bytes());
    if constexpr (sizeof...(more) > 0)
      download(more...);
    else
      finish_downloads();
  }
  void mark();
  template <class T>
  void download_marked(const Buffer<T>& from, std::span<T> to) {
    copy_marked(from.data(), to.data(), to.size_bytes());
  }
  template <class T>
  void copy(const Buffer<T>& from, Buffer<T>& to) {
    to.resize(from.size());
    check_cuda(
        cudaMemcpyAsync(to.data(), from.data(), from.size() * sizeof(T), cudaMemcpyDeviceToDevice, stream_),
        "copying on the device");
  }
  template <class T>
  void grow(Buffer<T>& b, std::size_t n) {
    if (b.size() >= n) return;
    Buffer<T> larger;
    larger.resize(n);
    if (b.size() > 0)
      check_cuda(
          cudaMemcpyAsync(larger.data(), b.data(), b.size() * sizeof(T), cudaMemcpyDeviceToDevice, stream_),
          "growing device memory");
    check_cuda(cudaStreamSynchronize(stream_), "growing device memory");
    b = std::move(larger);
  }
  template <class T>
  void zero(Buffer<T>& b, std::size_t n) {
    if (sizing_) return;
    check_cuda(cudaMemsetAsync(b.data(), 0, n * sizeof(T), stream_), "clearing device memory");
  }

  template <class F>
  void for_each(std::uint32_t n, F f) {
    if (sizing_ || n == 0) return;
    for_each_kernel<<<blocks(n, block(block_threads)), block(block_threads), 0, stream_>>>(n, f);
    check_cuda(cudaGetLastError(), "starting a kernel");
  }
  template <class CellOf>
  void sort_into_cells(std::uint32_t n, std::uint32_t cells, CellOf cell_of, std::uint32_t* key,
                       std::uint32_t* scratch, Buffer<std::uint32_t>& start, Buffer<std::uint32_t>& source,
                       IndexOrder order = {}) {
    zero(start, cells + 2);
    if (!sizing_)
      count_cells_kernel<<<blocks(n, block(block_threads)), block(block_threads), 0, stream_>>>(
          n, cell_of, key, source.data(), start.data());
    check_cuda(cudaGetLastError(), "starting a kernel");
    exclusive_sum(start, cells + 1);
    for_each(n, ScatterToCells{key, source.data(), start.data(), scratch});
    for_each(n, OrderInCells{key, scratch, start.data(), source.data(), order});
  }
  template <class T>
  void exclusive_sum(Buffer<T>& counts, std::uint32_t n) {
    with_scratch([&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveScan(scratch, bytes, counts.data(), counts.data(), Plus{}, T{},
                                            static_cast<int>(n), stream_);
    });
  }

 protected:
  unsigned block(unsigned usual) const { return std::min(usual, most_block_threads_); }
  static unsigned blocks(std::uint32_t threads, unsigned per_block) {
    return std::max(1u, (threads + per_block - 1) / per_block);
  }

  // Calls a CUB algorithm with scratch memory of the size that it requests.
  template <class Algorithm>
  void with_scratch(Algorithm algorithm) {
    std::size_t bytes = 0;
    check_cuda(algorithm(nullptr, bytes), "asking for scratch memory");
    if (scratch_.size() < bytes) {
      scratch_.resize(bytes);
      moved_scratch();
    }
    if (!sizing_) check_cuda(algorithm(scratch_.data(), bytes), "adding up");
  }

  // Scratch memory is elsewhere now: captured work refers to the old one.
  virtual void moved_scratch() {}

  cudaStream_t stream_ = nullptr;
  // While this is set, nothing is done: a dry run that finds how much scratch memory is needed.
  bool sizing_ = false;
  // Largest block of the kernels that go through memory (TANDEM_CUDA_BLOCK). Results do not depend on it;
  // tests vary it to show that.
  unsigned most_block_threads_ = ~0u;

 private:
  const void* staged(const void* from, std::size_t bytes);
  void begin_download(const void* from, void* to, std::size_t bytes);
  void finish_downloads();
  void copy_marked(const void* from, void* to, std::size_t bytes);

  // Of mark() and download_marked().
  cudaStream_t aside_ = nullptr;
  cudaEvent_t marked_ = nullptr;
  int device_ = 0;
  // Small copies to the host go through pinned memory: a copy to pageable memory would synchronise each time.
  struct Download {
    void* to;
    std::size_t at, bytes;  // in landing_
  };
  static constexpr std::size_t landing_bytes = 1 << 18;
  std::byte* landing_ = nullptr;
  std::size_t landed_ = 0;  // bytes in use
  std::vector<Download> downloads_;
  // Small copies to the device leave from pinned memory: one from pageable memory would wait for the work
  // before it. A download, which waits for the stream, makes the memory free again.
  static constexpr std::size_t departure_bytes = 1 << 16;
  std::byte* departure_ = nullptr;
  std::size_t departed_ = 0;  // bytes in use
  Buffer<std::byte> scratch_;
};

}  // namespace tandem::particles
