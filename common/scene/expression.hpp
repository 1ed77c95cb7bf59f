// Arithmetic expressions in a scene: "mouth/2 - 0.01*cos(pitch)".
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tandem::scene {

// A number that knows which power of an angle it is, so that degrees are not taken for radians.
struct Quantity {
  double value = 0;  // of angles in rad
  int angle = 0;     // 1: an angle; -1: per angle; 0: anything else
};

class ExpressionError : public std::runtime_error {
 public:
  using runtime_error::runtime_error;
};

// Grammar, the strongest binding first:
//   number, name, function(a, ...), (sum)
//   power   a ^ b, from the right; -a ^ b is -(a ^ b)
//   product a * b, a / b
//   sum     a + b, a - b: of two angles, or of two others
// Constants: pi, and deg and rad, which are angles of 1 degree and of 1 rad. Functions: sin, cos, tan (of an
// angle or a number in rad), asin, acos, atan, atan2 (angles), sqrt, exp, log, abs, hypot, min, max, floor,
// ceil, round. value_of: of any other name; it throws for one that is unknown.
// Throws ExpressionError for text that is no expression, with its column, and where no finite number follows.
Quantity evaluate(std::string_view text, const std::function<Quantity(const std::string&)>& value_of);

// The names that an expression has of its own.
const std::vector<std::string>& reserved_names();

}  // namespace tandem::scene
