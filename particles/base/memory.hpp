// Checks that a run fits into the memory of its processor before anything is allocated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "particles/base/backend.hpp"

namespace tandem::particles {

// Free memory of the device, or the memory that the host can still provide [bytes].
std::size_t available_memory(Backend backend);
// Memory that a host, whose files are below `root`, can still provide [bytes], within the limits of this
// process's control groups (containers, batch systems) and of its address space, which may grow to
// `addresses` in all.
std::size_t host_memory(const std::filesystem::path& root, std::size_t addresses);

struct MemoryNeed {
  std::size_t bytes = 0;  // at the start of the run
  std::size_t spheres = 0;
  std::size_t cells = 0;   // part of it for the cells of the domain [bytes]
  std::string where;       // "device" or "host"
  std::size_t window = 0;  // part of it for the data of each micro step of a window [bytes]
};
// Error{resource} with the figures when the need exceeds `available` [bytes].
void expect_memory(const MemoryNeed& need, std::size_t available);

}  // namespace tandem::particles
