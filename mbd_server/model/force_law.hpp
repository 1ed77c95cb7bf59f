// A force over one argument: nothing, a straight line, or a table.
#pragma once

#include <optional>

#include "common/math/piecewise_polynomial.hpp"
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
  bool present() const { return factor_ != 0 || tabled_; }

 private:
  double factor_ = 0;
  bool tabled_ = false;
  // A monotone cubic: it overshoots no given point, and its slope is continuous, which Newton's method needs.
  PiecewisePolynomial force_, energy_;
};

}  // namespace tandem::mbd
