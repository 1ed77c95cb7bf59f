#include "particles/base/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>

#include "common/control_groups.hpp"
#include "common/error.hpp"

namespace tandem::particles {

namespace fs = std::filesystem;

#if TANDEM_HAS_CUDA
std::size_t cuda_free_memory();
#else
static std::size_t cuda_free_memory() {
  return 0;
}
#endif

namespace {

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

// The number that a file begins with, if any.
std::optional<std::size_t> number_in(const fs::path& file) {
  std::size_t number = 0;
  return std::ifstream(file) >> number ? std::optional(number) : std::nullopt;
}

// The number after `key` at the begin of a line; 0 if there is none.
std::size_t number_after(const std::string& key, const fs::path& file) {
  std::ifstream lines(file);
  std::string word;
  for (std::size_t number = 0; lines >> word;) {
    if (word == key && lines >> number) return number;
    lines.clear();
    lines.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

std::size_t less(std::size_t limit, std::size_t used) {
  return limit > used ? limit - used : 0;
}

// Names of a control group's files, which depend on the version of the interface.
struct GroupFiles {
  const char *limit, *used, *active_cache, *inactive_cache;
};
constexpr GroupFiles version_1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_active_file",
                               "total_inactive_file"};
constexpr GroupFiles version_2{"memory.max", "memory.current", "active_file", "inactive_file"};

std::size_t left_of_groups(const fs::path& root, const std::string& controller, const GroupFiles& files) {
  std::size_t left = unlimited;
  for_each_control_group(root, controller, [&](const fs::path& folder) {
    const auto limit = number_in(folder / files.limit), used = number_in(folder / files.used);
    if (!limit || !used) return;
    // The kernel frees pages of the file cache when memory is requested.
    const std::size_t cache = number_after(files.active_cache, folder / "memory.stat") +
                              number_after(files.inactive_cache, folder / "memory.stat");
    left = std::min(left, less(*limit, less(*used, cache)));
  });
  return left;
}

}  // namespace

std::size_t host_memory(const fs::path& root, std::size_t addresses) {
  const std::size_t kilobytes = number_after("MemAvailable:", root / "proc/meminfo"),
                    of_host = kilobytes > 0 ? kilobytes * 1024 : unlimited;  // not every system has this file
  std::size_t of_addresses = unlimited;
  if (addresses != unlimited)
    of_addresses = less(addresses, number_in(root / "proc/self/statm").value_or(0) *
                                       static_cast<std::size_t>(sysconf(_SC_PAGESIZE)));
  return std::min({of_host, left_of_groups(root, "", version_2), left_of_groups(root, "memory", version_1),
                   of_addresses});
}

std::size_t available_memory(Backend backend) {
  if (backend == Backend::cuda) return cuda_free_memory();
  rlimit limit{};
  const bool limited = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return host_memory("/", limited ? limit.rlim_cur : unlimited);
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
  std::string remedy = "use fewer spheres or a smaller domain, a law without friction, or another processor";
  if (need.window > need.bytes / 4) {
    problem +=
        fmt::format(", {:.4g} GB of it for the loads of a window's micro steps", gigabytes(need.window));
    remedy = "use shorter windows or a longer micro step, or another processor";
  }
  throw Error(ErrorCode::resource, problem + fmt::format("; {:.4g} GB are free", gigabytes(available)),
              need.where + " memory", remedy);
}

}  // namespace tandem::particles
