// Prints error against step size, and asks for an order of convergence.
#pragma once

#include <string>
#include <vector>

namespace tandem::mbd {

// Order of convergence over one halving, as text; empty for the first row (coarse = 0).
std::string slope_text(double coarse, double fine);

class OrderTable {
 public:
  explicit OrderTable(std::string title) : title_(std::move(title)) {}
  // Errors in position and velocity at step h.
  struct Errors {
    double position, velocity;
  };
  void add(double h, Errors errors) { rows_.push_back({h, errors}); }
  // Prints the table; every slope between neighbouring rows must be within `tolerance` of `order`.
  void expect_order(double order, double tolerance) const;

 private:
  struct Row {
    double h;
    Errors errors;
  };
  std::string title_;
  std::vector<Row> rows_;
};

}  // namespace tandem::mbd
