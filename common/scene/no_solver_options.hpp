// For our own solvers, which know no solver options.
#pragma once

#include <string>
#include <vector>

namespace tandem::scene {

// Throws Error{scene} with the first key. `part` is "mbd" or "dem", `program` the solver's.
void expect_no_solver_options(const std::vector<std::string>& keys, const std::string& origin,
                              const std::string& part, const std::string& program);

}  // namespace tandem::scene
