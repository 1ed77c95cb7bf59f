// Bounds that reading and validating a scene share.
#pragma once

#include <cmath>

namespace tandem::scene {

// Unit vectors and quaternions come as decimals; seven digits are taken as meant to be of unit length.
inline bool is_unit(double length) {
  return std::abs(length - 1) <= 1e-6;
}

// A value of seconds that is meant to be a whole number of nanoseconds is off by rounding only.
inline bool is_whole(double number) {
  return std::abs(number - std::round(number)) <= std::fmax(1e-6, 1e-15 * number);
}

}  // namespace tandem::scene
