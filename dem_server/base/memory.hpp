// Whether a run fits into the memory of its processor, asked before anything is allocated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "dem_server/base/backend.hpp"

namespace tandem::dem {

// Free memory of the device, or what the host can still give [bytes].
std::size_t available_memory(Backend backend);
// What a host whose files are below `root` can still give, within the limits of this process's control groups
// (containers, batch systems) and of its addresses, of which it may have `addresses` in all [bytes].
std::size_t host_memory(const std::filesystem::path& root, std::size_t addresses);

struct MemoryNeed {
  std::size_t bytes = 0;  // at the start of the run
  std::size_t spheres = 0;
  std::size_t cells = 0;   // bytes of it for the cells of the domain
  std::string where;       // "device" or "host"
  std::size_t window = 0;  // bytes of it for what is kept of each micro step of a window
};
// Error{resource} with the figures when that is more than `available` [bytes].
void expect_memory(const MemoryNeed& need, std::size_t available);

}  // namespace tandem::dem
