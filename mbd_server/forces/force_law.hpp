// A force over one argument: nothing, a straight line, or a table.
#pragma once

#include <optional>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::mbd {

class ForceLaw {
 public:
  ForceLaw() = default;
  // The table where there is one, else factor * argument.
  explicit ForceLaw(double factor, const std::optional<scene::ForceTable>& table = {});

  struct Value {
    double force = 0, slope = 0;
  };
  Value at(double x) const;
  // Integral of the force from 0 to x.
  double energy(double x) const;
  bool present() const { return factor_ != 0 || !x_.empty(); }

 private:
  std::size_t interval(double x) const;
  double primitive(double x) const;  // from x_[0]

  double factor_ = 0;
  // Monotone cubic Hermite interpolation (Fritsch, Carlson, SIAM J. Numer. Anal. 17, 1980): it overshoots no
  // given point, and its slope is continuous, which Newton's method needs.
  std::vector<double> x_, y_, slope_, sum_;  // points, slopes, integral up to each point
};

}  // namespace tandem::mbd
