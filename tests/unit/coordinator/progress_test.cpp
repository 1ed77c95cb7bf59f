#include "coordinator/run/progress.hpp"

#include <gtest/gtest.h>

namespace tandem::launch {
namespace {

TEST(Progress, CountsTheSpheresThatAreThere) {
  const Progress progress({0}, 0, to_nanoseconds(2), true);
  const Nanoseconds now = to_nanoseconds(0.5);
  EXPECT_EQ(progress.line(now, 50, 1000, 300, 10),
            "t = 0.5 of 2 s (25 %), 50 windows, 100 micro steps/s, 3e+04 sphere-steps/s, 30 s left");
  EXPECT_EQ(progress.line(now, 50, 1000, 0, 10),
            "t = 0.5 of 2 s (25 %), 50 windows, 100 micro steps/s, 30 s left");
}

}  // namespace
}  // namespace tandem::launch
