#include "particles/base/backend.hpp"
#include "particles/base/check_cuda.cuh"

namespace tandem::particles {

std::string cuda_device_name();
std::size_t cuda_free_memory();

unsigned cuda_devices() {
  int devices = 0;
  return cudaGetDeviceCount(&devices) == cudaSuccess ? static_cast<unsigned>(devices) : 0;
}
bool cuda_present() {
  return cuda_devices() > 0;
}
void use_cuda_device(unsigned number) {
  if (const unsigned devices = cuda_devices(); devices > 0)
    check_cuda(cudaSetDevice(static_cast<int>(number % devices)), "choosing a device");
}

std::string cuda_device_name() {
  cudaDeviceProp properties{};
  int device = 0;
  check_cuda(cudaGetDevice(&device), "asking for the device");
  check_cuda(cudaGetDeviceProperties(&properties, device), "asking for the device's name");
  return properties.name;
}

std::size_t cuda_free_memory() {
  std::size_t available = 0, all = 0;
  check_cuda(cudaMemGetInfo(&available, &all), "asking for the free memory");
  return available;
}

}  // namespace tandem::particles
