// Limits of the schemes for a body in a liquid, measured through the coordinator and real channels: the body
// (mass 1) radiates sound (damper R) into an added mass m_a. docs/coupling.md has the formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "coordinator/schemes/liquid_map.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "tests/doubles/coupled_oscillator.hpp"

namespace tandem::test {
namespace liquid_test {

using scene::Scheme;

constexpr double round_off = 1e-6;
const double never = INFINITY;

scene::Coupling coupling(Scheme scheme) {
  scene::Coupling how;
  how.scheme = scheme;
  how.window = 1e6;  // the length of each window is given where it is advanced
  how.iteration = scene::Iteration{{.length = 1e-13, .tolerance = 1e-10}};
  return how;
}

// m_a = ratio, R = 1: the body alone would stop within a second.
OscillatorBedParameters liquid(double ratio) {
  return {.mass = ratio, .contact_stiffness = 0, .contact_damping = 1, .responds = true};
}
double by_then(double ratio, double share) {  // when 1 - exp(-H R / m_a) has that share
  return share < 1 ? -ratio * std::log1p(-share) : never;
}

double measured_limit(Scheme scheme, double ratio) {
  CoupledOscillator pair({1, 0, 0}, liquid(ratio), coupling(scheme));
  const auto stable = [&](double H) { return pair.growth(H) <= 1 + round_off; };
  double low = 0.05, high = low;
  if (!stable(low)) return 0;
  while (stable(high *= 1.3)) {
    low = high;
    if (high > 20 * (1 + ratio)) return never;
  }
  while (high - low > 1e-3 * low) (stable((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

void expect_limit(const char* what, double ratio, double expected, double measured, double tolerance) {
  std::printf(
      "%s, added mass %g times its own: longest window, expected %.4g s, measured %.4g s, tolerance %g\n",
      what, ratio, expected, measured, tolerance);
  if (std::isinf(expected))
    EXPECT_TRUE(std::isinf(measured));
  else
    EXPECT_NEAR(measured, expected, tolerance * expected);
}

// (1 + m_a/m) (1 - exp(-R H / m_a)) < 2, and (m_a/m) (1 - exp(-R H / m_a)) < 1 where the load is a window
// late.
TEST(BodyInALiquid, LimitsAreThoseOfTheFormulas) {
  for (const double ratio : {0.9, 3.0, 100.0}) {
    expect_limit("dem_first", ratio, by_then(ratio, 2 / (1 + ratio)),
                 measured_limit(Scheme::dem_first, ratio), 0.005);
    expect_limit("parallel", ratio, by_then(ratio, 1 / ratio), measured_limit(Scheme::parallel, ratio),
                 0.005);
    expect_limit("implicit", ratio, never, measured_limit(Scheme::implicit, ratio), 0);
  }
}

TEST(BodyInALiquid, LimitsAreThoseOfTheWindowMap) {
  for (const double ratio : {3.0})
    for (const Scheme scheme : {Scheme::parallel, Scheme::mbd_first, Scheme::dem_first}) {
      OscillatorBed bed(liquid(ratio));
      launch::LiquidMode mode;
      for (const protocol::BodyResponse& point : bed.linearise().responses) {
        mode.time.push_back(point.time);
        mode.impulse.push_back(point.impulse[0]);
      }
      expect_limit(launch::name(scheme), ratio, launch::critical_window(coupling(scheme), mode),
                   measured_limit(scheme, ratio), 0.02);
    }
}

// The body is ahead of its liquid by the impulse of one window, which the liquid then records: in the end
// both have the momentum of the start.
TEST(BodyInALiquid, LinearImplicitIsStableAndKeepsTheMomentum) {
  for (const double ratio : {0.9, 3.0, 100.0})
    for (const double H : {0.05, 0.5, 5.0, 50.0}) {
      CoupledOscillator pair({1, 0, 0}, liquid(ratio), coupling(Scheme::linear_implicit));
      pair.body.v = 1;
      double largest = 0;
      const int windows = static_cast<int>(std::max(80.0, std::ceil(15 / H)));
      for (int i = 0; i < windows; ++i) {
        pair.advance(H);
        largest = std::max(largest, std::abs(pair.body.v));
      }
      std::printf(
          "linear_implicit, added mass %g, R H / m = %g: velocity at the end, expected %.5g, measured %.5g\n",
          ratio, H, 1 / (1 + ratio), pair.body.v);
      EXPECT_LE(largest, 1.001);
      EXPECT_NEAR(pair.body.v, 1 / (1 + ratio), 0.003);
    }
}

// The warning comes with the first window; the iteration starts from the response.
TEST(BodyInALiquid, IsNamedBeforeItFliesApart) {
  scene::Coupling how = coupling(Scheme::dem_first);
  how.window = 5;
  CoupledOscillator pair({1, 0, 0}, liquid(10), how);
  pair.body.v = 1;
  pair.advance(5);
  ASSERT_EQ(pair.coupler().warnings().size(), 1u);
  std::printf("  %s\n", pair.coupler().warnings()[0].c_str());
  EXPECT_NE(pair.coupler().warnings()[0].find("body 'mass' is light for the liquid on it: from window 0 on"),
            std::string::npos);
  EXPECT_NE(pair.coupler().warnings()[0].find("coupling.scheme = \"implicit\""), std::string::npos);
}

TEST(BodyInALiquid, OfAHundredthOfItsAddedMassConvergesAtAnyWindow) {
  for (const double ratio : {10.0, 100.0, 1e4})
    for (const double H : {0.1, 2.0, 20.0, 200.0}) {
      scene::Coupling how = coupling(Scheme::implicit);
      how.iteration = scene::Iteration{};
      CoupledOscillator pair({1, 0, 0}, liquid(ratio), how);
      pair.body.v = 1;
      double largest = 0;
      for (int i = 0; i < 50; ++i) {
        pair.advance(H);
        largest = std::max(largest, std::abs(pair.body.v));
      }
      const double iterations = static_cast<double>(pair.coupler().counters().iterations) / 50;
      std::printf("implicit, added mass %g, R H / m = %g: %.2f iterations in a window (expected at most 3)\n",
                  ratio, H, iterations);
      EXPECT_LE(iterations, 3);
      EXPECT_LE(largest, 1.001);
      EXPECT_TRUE(pair.coupler().warnings().empty());
    }
}

}  // namespace liquid_test
}  // namespace tandem::test
