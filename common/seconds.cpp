#include "common/seconds.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"

namespace tandem {

std::chrono::milliseconds bounded_seconds(double seconds, std::chrono::milliseconds least,
                                          std::chrono::milliseconds most, const std::string& option) {
  const double from = static_cast<double>(least.count()) / 1000,
               to = static_cast<double>(most.count()) / 1000;
  if (!(seconds >= from && seconds <= to))
    throw Error(ErrorCode::usage, fmt::format("{:g} s is out of bounds", seconds), option,
                fmt::format("give {:g} to {:g} s", from, to));
  return std::chrono::milliseconds(std::llround(1e3 * seconds));
}

}  // namespace tandem
