// Device memory that ranks on one host share: each writes into that of the others. Within a process by its
// address, between processes through CUDA IPC.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "particles/base/ranks.hpp"

namespace tandem::particles {

// Sent to other ranks as bytes.
struct PeerAddress {
  cudaIpcMemHandle_t handle;
  std::uint64_t pointer = 0;
  std::int32_t process = 0, device = 0;
};

// Memory of this rank that others open.
class SharedMemory {
 public:
  SharedMemory() = default;
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  // Makes it that long; a longer one begins with zeros. Others may still have the former one open, which
  // therefore stays until the end.
  void reserve(std::size_t bytes);
  std::byte* data() const { return data_; }
  const PeerAddress& address() const { return address_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  PeerAddress address_;
  std::vector<std::byte*> former_;
};

// Memory of other ranks that is open here.
class OpenedMemory {
 public:
  OpenedMemory() = default;
  ~OpenedMemory();
  OpenedMemory(const OpenedMemory&) = delete;
  OpenedMemory& operator=(const OpenedMemory&) = delete;

  std::byte* open(const PeerAddress& address);

 private:
  std::map<std::pair<std::int32_t, std::uint64_t>, std::byte*> opened_;  // by process and pointer
};

// Can the device of each rank write into the memory of each other one? Ranks on one device do not: where one
// waits for the other, the device may not run the other. Collective.
bool all_reach_each_other(Ranks& ranks);

}  // namespace tandem::particles
