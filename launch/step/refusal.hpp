// Why a file is not read: `tandem import` shows the sentence as its own error.
#pragma once

#include <stdexcept>
#include <string>

namespace tandem::step {

struct Refusal : std::runtime_error {
  Refusal(const std::string& problem, std::string remedy)
      : std::runtime_error(problem), hint(std::move(remedy)) {}
  std::string hint;
};

}  // namespace tandem::step
