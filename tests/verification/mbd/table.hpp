// Prints error against step size, and asks for an order of convergence.
#pragma once

#include <string>
#include <vector>

namespace tandem::mbd {

// Order of convergence over one halving, as text; empty for the first row (coarse = 0).
std::string slope_text(double coarse, double fine);

// One row per step size, one column per quantity.
class OrderTable {
 public:
  OrderTable(std::string title, std::vector<std::string> columns = {"position [m]", "velocity [m/s]"})
      : title_(std::move(title)), columns_(std::move(columns)) {}
  // One error for each column at step h.
  void add(double h, std::vector<double> errors) { rows_.push_back({h, std::move(errors)}); }
  // Prints the table; every slope between neighbouring rows must be within `tolerance` of `order`.
  void expect_order(double order, double tolerance) const;

 private:
  struct Row {
    double h;
    std::vector<double> errors;
  };
  std::string title_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

// Prints error, limit and processor time of a case, and asks for the error alone: times depend on the
// machine.
void expect_within(const std::string& what, double error, double limit, const std::string& unit,
                   double cpu_seconds);

}  // namespace tandem::mbd
