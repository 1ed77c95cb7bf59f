// A force as a function of one argument: zero, proportional, or given by a table.
#pragma once

#include <optional>

#include "common/math/piecewise_polynomial.hpp"
#include "common/scene/model.hpp"

namespace tandem::mbd {

class ForceLaw {
 public:
  ForceLaw() = default;
  // The table where there is one, otherwise factor * argument.
  explicit ForceLaw(double factor, const std::optional<scene::ForceTable>& table = {});

  struct Value {
    double force = 0, slope = 0;
  };
  Value at(double x) const;
  // Integral of the force from 0 to x.
  double energy(double x) const;
  bool present() const { return factor_ != 0 || tabled_; }

 private:
  double factor_ = 0;
  bool tabled_ = false;
  // A monotone cubic: it does not overshoot the given points, and its slope is continuous, as Newton's
  // method needs.
  PiecewisePolynomial force_, energy_;
};

}  // namespace tandem::mbd
