// Resolutions of an experiment.
#pragma once

#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tandem::test {

// The numbers of spacings in the environment variable TANDEM_SPACINGS, such as "12 20"; the usual ones where
// it is not set. std::invalid_argument for anything but whole numbers of 2 or more.
inline std::vector<int> spacings(const std::vector<int>& usual) {
  const char* given = std::getenv("TANDEM_SPACINGS");
  if (given == nullptr) return usual;
  std::istringstream text(given);
  std::vector<int> numbers;
  for (int number = 0; text >> number;) numbers.push_back(number);
  bool valid = text.eof() && !numbers.empty();
  for (const int number : numbers) valid = valid && number >= 2;
  if (!valid)
    throw std::invalid_argument("TANDEM_SPACINGS is \"" + std::string(given) +
                                "\": give whole numbers of 2 or more, such as \"12 20\"");
  return numbers;
}

}  // namespace tandem::test
