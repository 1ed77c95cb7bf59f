#include "particles/base/backend.hpp"

#include <fstream>
#include <thread>

#include "common/error.hpp"
#include "common/utf8.hpp"

namespace tandem::particles {

#if !TANDEM_HAS_CUDA
bool cuda_present() {
  return false;
}
unsigned cuda_devices() {
  return 0;
}
void use_cuda_device(unsigned) {}
std::string cuda_device_name() {
  return {};
}
#else
std::string cuda_device_name();
#endif

bool cuda_built() {
  return TANDEM_HAS_CUDA != 0;
}

Backend choose_backend(std::string_view wanted) {
  if (wanted == "cpu") return Backend::cpu;
  if (wanted == "cuda") {
    if (!cuda_built())
      throw Error(ErrorCode::resource, "this build has no CUDA", "--backend cuda",
                  "build with launch/build cuda, which needs nvcc, or use --backend cpu");
    if (!cuda_present())
      throw Error(ErrorCode::resource, "no CUDA device answers on this host", "--backend cuda",
                  "use --backend cpu");
    return Backend::cuda;
  }
  if (wanted != "auto")
    throw Error(ErrorCode::usage, "unknown back end '" + shortened(wanted) + "'", "--backend",
                "one of auto, cpu, cuda");
  return cuda_present() ? Backend::cuda : Backend::cpu;
}

std::string device_name(Backend backend) {
  if (backend == Backend::cuda) return cuda_device_name();
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown CPU";
}

}  // namespace tandem::particles
