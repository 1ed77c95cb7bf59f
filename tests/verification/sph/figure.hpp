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

// The same for a figure that docs/validation.md lists as not met: it is printed, and no failure.
inline void print_figure(const char* what, double expected, double measured, double wanted) {
  std::printf("  %-46s expected %12.6g  measured %12.6g  wanted within %8.2g: %s\n", what, expected, measured,
              wanted, std::fabs(measured - expected) <= wanted ? "met" : "not met");
}

}  // namespace tandem::test
