// Makes inputs, runs a target on them in worker processes, and saves an input that causes a finding.
#pragma once

#include <cstdint>
#include <filesystem>

#include "tests/fuzz/target.hpp"

namespace tandem::fuzz {

struct Plan {
  std::uint64_t count = 0;  // inputs
  double seconds = 0;       // time limit [s]; 0: none
  std::uint64_t seed = 1;
  unsigned jobs = 1;     // processes; the inputs do not depend on their number
  double patience = 15;  // an input that takes longer is a finding [s]
};

// Runs a plan and prints its figures. Returns the exit status: 0, or 1 with a finding, whose input is saved
// in the working folder.
int run_plan(const TargetKind& kind, const Plan& plan);

// Runs the input of one file in this process, for use with a debugger. Returns the same exit status.
int run_file(const TargetKind& kind, const std::filesystem::path& file);

}  // namespace tandem::fuzz
