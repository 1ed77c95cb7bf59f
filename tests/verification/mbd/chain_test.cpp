// The cost of a step grows linearly with the links: printed here for short chains, measured to 10,000 links
// by tests/benchmark/mbd.
#include <gtest/gtest.h>

#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace chain_test {

TEST(Chain, KeepsItsEnergyAtLinearCost) {
  for (const int links : {16, 64, 256, 1024}) {
    machines::Run run(machines::chain(links), 1e-3, 0.9, {1e-10, 20});
    const double start = run.energy();
    const int steps = 20000 / links;
    const double cpu = run.advance_timed(steps);
    std::printf("%.3f us per step and link; ", 1e6 * cpu / steps / links);
    expect_within("chain of " + std::to_string(links) + " links, " + std::to_string(steps) + " steps",
                  std::abs(run.energy() - start), 1e-4, "J", cpu);
  }
}

}  // namespace chain_test
}  // namespace tandem::mbd
