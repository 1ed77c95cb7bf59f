// Makes inputs, has processes of its own go through them, and keeps the input that one of them dies of.
#pragma once

#include <cstdint>
#include <filesystem>

#include "tests/fuzz/target.hpp"

namespace tandem::fuzz {

struct Plan {
  std::uint64_t count = 0;  // inputs
  double seconds = 0;       // 0: until all inputs are done
  std::uint64_t seed = 1;
  unsigned jobs = 1;     // processes; which inputs are made does not depend on it
  double patience = 15;  // an input that takes longer is a finding [s]
};

// Prints the figures. Exit status: 0, or 1 with a finding, whose input is saved in the working folder.
int run_plan(const TargetKind& kind, const Plan& plan);

// One input from a file, in this process, as a debugger wants it. The same exit status.
int run_file(const TargetKind& kind, const std::filesystem::path& file);

}  // namespace tandem::fuzz
