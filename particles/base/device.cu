#include "particles/base/backend.hpp"
#include "particles/base/check_cuda.cuh"

namespace tandem::particles {

std::string cuda_device_name();
std::size_t cuda_free_memory();

bool cuda_present() {
  int devices = 0;
  return cudaGetDeviceCount(&devices) == cudaSuccess && devices > 0;
}

std::string cuda_device_name() {
  cudaDeviceProp properties{};
  check_cuda(cudaGetDeviceProperties(&properties, 0), "asking for the device's name");
  return properties.name;
}

std::size_t cuda_free_memory() {
  std::size_t available = 0, all = 0;
  check_cuda(cudaMemGetInfo(&available, &all), "asking for the free memory");
  return available;
}

}  // namespace tandem::particles
