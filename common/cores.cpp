#include "common/cores.hpp"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

namespace tandem {

namespace fs = std::filesystem;

unsigned cores_of_groups(const fs::path& root) {
  std::ifstream groups(root / "proc/self/cgroup");
  double cores = 0;
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::")) continue;
    // A container may see its own group as the topmost.
    for (fs::path group = fs::path(line.substr(3)).relative_path();; group = group.parent_path()) {
      std::ifstream limit(root / "sys/fs/cgroup" / group / "cpu.max");
      double time = 0, period = 0;
      if (limit >> time >> period && time > 0 && period > 0)
        cores = cores > 0 ? std::min(cores, time / period) : time / period;
      if (group.empty()) break;
    }
  }
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
