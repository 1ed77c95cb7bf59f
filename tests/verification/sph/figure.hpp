// A line of a table: what was expected, what was measured, and the tolerance.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace tandem::test {

inline void expect_figure(const char* what, double expected, double measured, double tolerance) {
  std::printf("  %-46s expected %12.6g  measured %12.6g  tolerance %8.2g\n", what, expected, measured,
              tolerance);
  EXPECT_LE(std::fabs(measured - expected), tolerance) << what;
}

}  // namespace tandem::test
