#include "common/seconds.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"

namespace tandem {
namespace {

using namespace std::chrono_literals;

TEST(Seconds, AreTakenToTheMillisecondWithinTheBounds) {
  EXPECT_EQ(bounded_seconds(1.2344, 50ms, 10s, "--lease"), 1234ms);
  EXPECT_EQ(bounded_seconds(0.05, 50ms, 10s, "--lease"), 50ms);
  EXPECT_EQ(bounded_seconds(10, 50ms, 10s, "--lease"), 10s);
}

TEST(Seconds, OutsideTheyAreRefusedWithTheBounds) {
  for (const double wrong : {0.049, 10.01, -1.0, 1e300, std::nan(""), HUGE_VAL}) {
    try {
      bounded_seconds(wrong, 50ms, 10s, "--lease");
      ADD_FAILURE() << wrong << " s was taken";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage);
      EXPECT_EQ(e.where(), "--lease");
      EXPECT_EQ(e.hint(), "give 0.05 to 10 s");
    }
  }
}

}  // namespace
}  // namespace tandem
