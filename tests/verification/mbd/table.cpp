#include "tests/verification/mbd/table.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tandem::mbd {

std::string slope_text(double coarse, double fine) {
  char text[16] = "";
  if (coarse > 0) std::snprintf(text, sizeof text, "%.3f", std::log2(coarse / fine));
  return text;
}

void OrderTable::expect_order(double order, double tolerance) const {
  std::printf("%s\n%12s %12s %7s %12s %7s   (expected slope %.1f +- %.1f)\n", title_.c_str(), "h [s]",
              "position [m]", "slope", "velocity", "slope", order, tolerance);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto& [h, e] = rows_[i];
    if (i == 0) {
      std::printf("%12.4e %12.3e %7s %12.3e %7s\n", h, e.position, "", e.velocity, "");
      continue;
    }
    const auto& last = rows_[i - 1];
    const double halvings = std::log(last.h / h);
    const double q = std::log(last.errors.position / e.position) / halvings;
    const double v = std::log(last.errors.velocity / e.velocity) / halvings;
    std::printf("%12.4e %12.3e %7.3f %12.3e %7.3f\n", h, e.position, q, e.velocity, v);
    EXPECT_NEAR(q, order, tolerance) << title_ << ", position";
    EXPECT_NEAR(v, order, tolerance) << title_ << ", velocity";
  }
}

}  // namespace tandem::mbd
