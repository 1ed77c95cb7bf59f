#include "common/time.hpp"

#include <gtest/gtest.h>

namespace tandem {
namespace {

TEST(Time, SecondsBecomeTheNearestNanosecond) {
  EXPECT_EQ(to_nanoseconds(1e-3).count, 1'000'000);
  EXPECT_EQ(to_nanoseconds(2.89e-6).count, 2890);
  EXPECT_EQ(to_nanoseconds(0.1 + 0.2).count, 300'000'000);
  EXPECT_EQ(to_nanoseconds(-1.4e-9).count, -1);
}

TEST(Time, ManyWindowsDoNotDrift) {
  Nanoseconds now;
  for (int i = 0; i < 1'000'000; ++i) now = now + to_nanoseconds(1e-3);
  EXPECT_EQ(to_seconds(now), 1000.0);
}

TEST(Time, WindowLength) {
  const Window window{.index = 3, .begin = {3'000'000}, .end = {4'000'000}};
  EXPECT_DOUBLE_EQ(window.length(), 1e-3);
}

}  // namespace
}  // namespace tandem
