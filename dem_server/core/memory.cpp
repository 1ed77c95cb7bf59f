#include "dem_server/core/memory.hpp"

#include <fmt/format.h>

#include <fstream>
#include <limits>

#include "common/error.hpp"

namespace tandem::dem {

#if TANDEM_HAS_CUDA
std::size_t cuda_free_memory();
#else
static std::size_t cuda_free_memory() {
  return 0;
}
#endif

std::size_t available_memory(Backend backend) {
  if (backend == Backend::cuda) return cuda_free_memory();
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("MemAvailable:")) return std::stoull(line.substr(13)) * 1024;
  return std::numeric_limits<std::size_t>::max();  // a system that does not tell
}

void expect_memory(const MemoryNeed& need, std::size_t available) {
  if (need.bytes <= available) return;
  const auto gigabytes = [](std::size_t bytes) { return static_cast<double>(bytes) / 1e9; };
  std::string problem =
      fmt::format("{} spheres need {:.4g} GB of {} memory", need.spheres, gigabytes(need.bytes), need.where);
  if (need.spheres > 0)
    problem +=
        fmt::format(", {:.0f} B each", static_cast<double>(need.bytes) / static_cast<double>(need.spheres));
  if (need.cells > need.bytes / 4)
    problem += fmt::format(", {:.4g} GB of it for the cells of dem.domain", gigabytes(need.cells));
  throw Error(ErrorCode::resource, problem + fmt::format("; {:.4g} GB are free", gigabytes(available)),
              need.where + " memory",
              "use fewer spheres or a smaller domain, a law without friction, or another processor");
}

}  // namespace tandem::dem
