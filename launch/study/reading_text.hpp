// reading.txt: orders and fronts in words.
#pragma once

#include <string>
#include <vector>

#include "launch/study/reading.hpp"

namespace tandem::launch {

// Error by measure `m`, time and settings of a row, with its objection if it is suspect.
std::string row_text(const Row& row, std::size_t m);

std::string reading_of(const Study& study, const Plan& plan, const std::vector<Row>& rows);

}  // namespace tandem::launch
