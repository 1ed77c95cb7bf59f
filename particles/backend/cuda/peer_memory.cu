#include <unistd.h>

#include <mutex>
#include <set>
#include <utility>

#include "particles/backend/cuda/peer_memory.cuh"
#include "particles/backend/setting.hpp"
#include "particles/base/check_cuda.cuh"

namespace tandem::particles {

namespace {

int present_device() {
  int device = 0;
  check_cuda(cudaGetDevice(&device), "asking for the device");
  return device;
}

// Once for each pair of devices in a process.
void reach(int device) {
  static std::mutex one_at_a_time;
  static std::set<std::pair<int, int>> reached;
  const std::scoped_lock lock(one_at_a_time);
  if (reached.emplace(present_device(), device).second)
    check_cuda(cudaDeviceEnablePeerAccess(device, 0), "reaching the memory of another device");
}

}  // namespace

SharedMemory::~SharedMemory() {
  for (std::byte* former : former_) cudaFree(former);
  cudaFree(data_);
}

void SharedMemory::reserve(std::size_t bytes) {
  if (bytes <= size_) return;
  if (data_ != nullptr) former_.push_back(data_);
  size_ = bytes + bytes / 4;
  void* fresh = nullptr;
  check_cuda(cudaMalloc(&fresh, size_), "allocating device memory that ranks share");
  data_ = static_cast<std::byte*>(fresh);
  check_cuda(cudaMemset(data_, 0, size_), "clearing device memory");
  check_cuda(cudaDeviceSynchronize(), "clearing device memory");
  address_.pointer = reinterpret_cast<std::uint64_t>(data_);
  address_.process = getpid();
  address_.device = present_device();
  check_cuda(cudaIpcGetMemHandle(&address_.handle, data_), "sharing device memory");
}

OpenedMemory::~OpenedMemory() {
  for (const auto& [of, data] : opened_)
    if (of.first != getpid()) cudaIpcCloseMemHandle(data);
}

std::byte* OpenedMemory::open(const PeerAddress& address) {
  std::byte*& data = opened_[{address.process, address.pointer}];
  if (data != nullptr) return data;
  if (address.process == getpid()) {
    if (address.device != present_device()) reach(address.device);
    data = reinterpret_cast<std::byte*>(address.pointer);
  } else {
    void* opened = nullptr;
    check_cuda(cudaIpcOpenMemHandle(&opened, address.handle, cudaIpcMemLazyEnablePeerAccess),
               "opening the device memory of another rank");
    data = static_cast<std::byte*>(opened);
  }
  return data;
}

bool all_reach_each_other(Ranks& ranks) {
  std::uint64_t apart[] = {ranks.on_this_host() < ranks.size() || setting("TANDEM_CUDA_PEERS") == 0u ? 1u
                                                                                                     : 0u};
  ranks.maximum(apart);
  if (apart[0] != 0) return false;
  const int here = present_device();
  const std::vector<int> devices = exchange_values<int>(ranks, std::vector<int>(ranks.size(), here));
  for (unsigned rank = 0; rank < ranks.size(); ++rank) {
    if (rank == ranks.rank()) continue;
    int reaches = 0;
    if (devices[rank] != here)
      check_cuda(cudaDeviceCanAccessPeer(&reaches, here, devices[rank]),
                 "asking what devices reach each other");
    if (reaches == 0) apart[0] = 1;
  }
  ranks.maximum(apart);
  return apart[0] == 0;
}

}  // namespace tandem::particles
