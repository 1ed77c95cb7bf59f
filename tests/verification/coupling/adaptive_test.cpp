// The window that follows the error: it keeps to its limits, it costs fewer windows than a fixed one of the
// same error, and a window that was taken back leaves no trace.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/doubles/coupled_oscillator.hpp"
#include "tests/verification/coupling/real_run.hpp"

namespace tandem::test {
namespace adaptive_test {

constexpr double end_time = 1.5;  // [s]

// The relative motion of the masses dies away, and then a longer window will do.
const OscillatorBodyParameters adaptive_body{1, 4, 0};
const OscillatorBedParameters adaptive_bed{1, 36, 1, 4, 0};

scene::Coupling adaptive(scene::Scheme scheme, double energy, double path) {
  scene::Coupling how;
  how.scheme = scheme;
  how.window = 0.01;
  how.adaptive = scene::Adaptive{
      {.energy_tolerance = energy, .max_window = 0.05, .min_window = 1e-4, .path_tolerance = path}};
  return how;
}

struct AdaptiveCourse {
  std::vector<Nanoseconds> ends;  // of the windows
  double x = 0, v = 0, y = 0, w = 0;
  std::uint64_t rejected = 0;
};

AdaptiveCourse course_of(CoupledOscillator& pair) {
  return {{}, pair.body.x, pair.body.v, pair.bed.y, pair.bed.w, pair.coupler().counters().rejected};
}

AdaptiveCourse run(const scene::Coupling& how) {
  CoupledOscillator pair(adaptive_body, adaptive_bed, how);
  pair.body.x = 1;
  std::vector<Nanoseconds> ends;
  const Nanoseconds end = to_nanoseconds(end_time);
  while (pair.coupler().now() < end) {
    pair.coupler().advance(end);
    const Window& window = pair.coupler().last_window();
    ends.push_back(window.end);
    const double H = window.length(), micro = pair.exchange().load.account.micro_step;
    // The last two windows are cut to meet the end.
    if (end - window.end > to_nanoseconds(how.adaptive->max_window)) {
      EXPECT_GE(H, how.adaptive->min_window);
    }
    EXPECT_LE(H, how.adaptive->max_window);
    const double ratio = H / micro;
    EXPECT_NEAR(ratio, std::round(ratio), 1e-9 * ratio) << "micro steps in a window";
  }
  EXPECT_EQ(ends.back(), end);
  AdaptiveCourse course = course_of(pair);
  course.ends = ends;
  return course;
}

// The same windows, none of which is tried before.
AdaptiveCourse run_again(scene::Coupling how, const std::vector<Nanoseconds>& ends) {
  how.adaptive.reset();
  how.window = 1e6;
  CoupledOscillator pair(adaptive_body, adaptive_bed, how);
  pair.body.x = 1;
  for (const Nanoseconds end : ends) pair.coupler().advance(end);
  return course_of(pair);
}

class Adaptive : public testing::TestWithParam<scene::Scheme> {};
// Scheme implicit has neither error: it creates no energy, and the bodies end where the particles were led.
INSTANTIATE_TEST_SUITE_P(Schemes, Adaptive,
                         testing::Values(scene::Scheme::dem_first, scene::Scheme::linear_implicit),
                         [](const auto& scheme) { return std::string(launch::name(scheme.param)); });

TEST_P(Adaptive, RejectedWindowsLeaveNoTrace) {
  scene::Coupling how = adaptive(GetParam(), 1e-2, 1e-3);
  how.window = how.adaptive->max_window;  // which misses the tolerance by far
  const AdaptiveCourse tried = run(how), plain = run_again(how, tried.ends);
  std::printf("  %-15s %zu windows, %lu taken back; shortest and longest as allowed\n",
              launch::name(GetParam()), tried.ends.size(), static_cast<unsigned long>(tried.rejected));
  EXPECT_GT(tried.rejected, 0u);
  EXPECT_EQ(plain.rejected, 0u);
  EXPECT_EQ(tried.x, plain.x);
  EXPECT_EQ(tried.v, plain.v);
  EXPECT_EQ(tried.y, plain.y);
  EXPECT_EQ(tried.w, plain.w);
}

TEST(AdaptiveError, FollowsTheTolerance) {
  // Of a run with windows that no longer matter.
  scene::Coupling fine;
  fine.load = scene::LoadShape::linear;
  fine.path = scene::PathShape::quadratic;
  fine.window = 5e-4;
  CoupledOscillator reference(adaptive_body, adaptive_bed, fine);
  reference.body.x = 1;
  reference.run(end_time);
  double last = 0;
  std::size_t last_windows = 0;
  for (const double tolerance : {1e-2, 3e-3, 1e-3}) {
    const AdaptiveCourse course = run(adaptive(scene::Scheme::dem_first, tolerance, tolerance));
    const double error = std::hypot(course.x - reference.body.x, course.y - reference.bed.y);
    std::printf("  %-15s tolerance %.0e: error %.2e m in %zu windows, %lu taken back\n",
                launch::name(scene::Scheme::dem_first), tolerance, error, course.ends.size(),
                static_cast<unsigned long>(course.rejected));
    if (last > 0) {
      EXPECT_LT(error, last);
      EXPECT_GT(course.ends.size(), last_windows);
    }
    last = error;
    last_windows = course.ends.size();
  }
}

// A plate that bounces on spheres: no contact, then a hard one.
TEST(AdaptiveReal, RejectedWindowsLeaveNoTrace) {
  std::ifstream file(TANDEM_STIFF_SCENES "/bouncing.json");
  nlohmann::json scene = nlohmann::json::parse(file);
  const double last = 0.4;  // [s]
  scene["end_time"] = last;
  scene["coupling"]["window"] = 2e-3;
  scene["coupling"]["adaptive"] = {
      {"energy_tolerance", 1e-2}, {"path_tolerance", 1e-4}, {"min_window", 1e-4}, {"max_window", 4e-3}};
  scene.erase("output");
  const std::string text = scene.dump();

  RealRun tried(text);
  std::vector<Nanoseconds> ends;
  double shortest = 1, longest = 0;
  const Nanoseconds end = to_nanoseconds(last);
  while (tried.coupler().now() < end) {
    tried.coupler().advance(end);
    const Window& window = tried.coupler().last_window();
    ends.push_back(window.end);
    shortest = std::min(shortest, window.length());
    longest = std::max(longest, window.length());
  }
  std::printf(
      "  %zu windows of %.3g to %.3g ms, %lu taken back, %lu too wrong; energy residual %.1e\n", ends.size(),
      1e3 * shortest, 1e3 * longest, static_cast<unsigned long>(tried.coupler().counters().rejected),
      static_cast<unsigned long>(tried.coupler().too_wrong()), tried.coupler().accounts().energy_residual());
  EXPECT_GT(tried.coupler().counters().rejected, 0u);
  EXPECT_GT(longest, 2 * shortest);

  scene::Coupling plain = scene::parse(text, "test").coupling;
  plain.adaptive.reset();
  plain.window = 1e6;
  RealRun straight(text, plain);
  for (const Nanoseconds window : ends) straight.coupler().advance(window);
  EXPECT_EQ(mbd::hash(straight.mbd.state()), mbd::hash(tried.mbd.state()));
  EXPECT_EQ(straight.dem.observe().position, tried.dem.observe().position);
  EXPECT_EQ(straight.dem.observe().velocity, tried.dem.observe().velocity);
}

}  // namespace adaptive_test
}  // namespace tandem::test
