// The rules about the liquid, the last ones of the table in docs/verdict.md.
#pragma once

#include <vector>

#include "launch/verdict/verdict.hpp"

namespace tandem::launch {

void add_liquid_rules(std::vector<Rule>& table);

}  // namespace tandem::launch
