// Bounds that reading and validating a scene share.
#pragma once

#include <cmath>

namespace tandem::scene {

// Unit vectors and quaternions are given in decimals; seven correct digits count as unit length.
inline bool is_unit(double length) {
  return std::abs(length - 1) <= 1e-6;
}

// A time in seconds that is meant to be a whole number of nanoseconds differs from one by rounding only.
inline bool is_whole(double number) {
  return std::abs(number - std::round(number)) <= std::fmax(1e-6, 1e-15 * number);
}

}  // namespace tandem::scene
