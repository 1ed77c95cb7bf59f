#include "common/cores.hpp"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

#include "common/control_groups.hpp"

namespace tandem {

namespace fs = std::filesystem;

unsigned cores_of_groups(const fs::path& root) {
  double cores = 0;
  for_each_control_group(root, "", [&](const fs::path& folder) {
    std::ifstream limit(folder / "cpu.max");
    double time = 0, period = 0;
    if (limit >> time >> period && time > 0 && period > 0)
      cores = cores > 0 ? std::min(cores, time / period) : time / period;
  });
  return static_cast<unsigned>(std::ceil(cores));
}

unsigned usable_cores() {
  cpu_set_t set;
  const unsigned allowed = sched_getaffinity(0, sizeof set, &set) == 0
                               ? static_cast<unsigned>(CPU_COUNT(&set))
                               : std::thread::hardware_concurrency(),
                 cores = std::max(1u, allowed), limit = cores_of_groups("/");
  return limit > 0 ? std::min(cores, limit) : cores;
}

}  // namespace tandem
