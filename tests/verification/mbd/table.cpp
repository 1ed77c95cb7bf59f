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
  std::printf("%s   (expected slope %.1f +- %.1f)\n%12s", title_.c_str(), order, tolerance, "h [s]");
  for (const std::string& column : columns_) std::printf(" %16s %7s", column.c_str(), "slope");
  std::printf("\n");
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::printf("%12.4e", rows_[i].h);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const double error = rows_[i].errors.at(k);
      if (i == 0) {
        std::printf(" %16.3e %7s", error, "");
        continue;
      }
      const double slope =
          std::log(rows_[i - 1].errors.at(k) / error) / std::log(rows_[i - 1].h / rows_[i].h);
      std::printf(" %16.3e %7.3f", error, slope);
      EXPECT_NEAR(slope, order, tolerance) << title_ << ", " << columns_[k];
    }
    std::printf("\n");
  }
}

void expect_within(const std::string& what, double error, double limit, const std::string& unit,
                   double cpu_seconds) {
  std::printf("%-58s error %9.2e %s, limit %9.2e, %9.3f ms of processor time\n", what.c_str(), error,
              unit.c_str(), limit, 1e3 * cpu_seconds);
  EXPECT_LE(error, limit) << what;
}

}  // namespace tandem::mbd
