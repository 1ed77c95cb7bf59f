// Adaptive windows: repeated rejections end.
#include "coordinator/window/window_control.hpp"

#include <gtest/gtest.h>

namespace tandem::launch {
namespace {

// Windows with an error that is always too large: their lengths until one is accepted [s].
std::vector<double> until_accepted(double min_window, double micro_step) {
  scene::Coupling coupling;
  coupling.window = 1e-3;
  coupling.adaptive.emplace();
  coupling.adaptive->min_window = min_window;
  coupling.adaptive->max_window = 1e-3;
  coupling.adaptive->path_tolerance = 1e-6;
  WindowControl control(coupling);
  std::vector<double> lengths;
  for (int i = 0; i < 100; ++i) {
    const Window window{0, {}, control.end({}, to_nanoseconds(1))};
    lengths.push_back(window.length());
    if (control.accept(window, {.energy = 0, .exchanged = 0, .path = 1}, micro_step, 1)) {
      EXPECT_EQ(control.too_wrong(), 1u);
      return lengths;
    }
    EXPECT_TRUE(lengths.size() < 2 || lengths.back() < lengths[lengths.size() - 2]);
  }
  ADD_FAILURE() << "no end of rejections at " << lengths.back() << " s";
  return lengths;
}

TEST(WindowControl, TheShortestWindowAllowedStays) {
  EXPECT_DOUBLE_EQ(until_accepted(1e-4, 1e-5).back(), 1e-4);
}

TEST(WindowControl, AWindowOfOneMicroStepStays) {
  EXPECT_DOUBLE_EQ(until_accepted(1e-6, 4e-4).back(), 4e-4);
}

// The same where a window cannot be computed.
TEST(WindowControl, NothingIsShorterThanOneMicroStep) {
  scene::Coupling coupling;
  coupling.window = 1e-3;
  coupling.adaptive.emplace();
  coupling.adaptive->min_window = 1e-6;
  coupling.adaptive->max_window = 1e-3;
  WindowControl control(coupling);
  EXPECT_TRUE(control.shorten({0, {}, to_nanoseconds(1e-3)}, 4e-4));
  EXPECT_FALSE(control.shorten({0, {}, to_nanoseconds(4e-4)}, 4e-4));
}

}  // namespace
}  // namespace tandem::launch
