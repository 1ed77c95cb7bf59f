// Limits of stability of each scheme, measured through the coordinator and real channels on a body whose
// contact (k, d) lives on the particles' side, against the table of the literature study and against
// window_map.hpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "coordinator/schemes/schemes.hpp"
#include "coordinator/schemes/window_map.hpp"
#include "tests/doubles/coupled_oscillator.hpp"

namespace tandem::test {
namespace stability_test {

using scene::LoadShape;
using scene::PathShape;
using scene::Scheme;

constexpr double zetas[] = {0, 0.02, 0.05, 0.1, 0.2, 0.5};

struct Case {
  const char* name;
  Scheme scheme;
  LoadShape load;
  double critical[6];  // omega H at each zeta, of the study (two decimals)
};

const Case cases[] = {
    {"parallel_end", Scheme::parallel, LoadShape::end, {0, .08, .19, .32, .45, .49}},
    {"parallel_mean", Scheme::parallel, LoadShape::mean, {0, .04, .10, .19, .35, .50}},
    {"mbd_first_end", Scheme::mbd_first, LoadShape::end, {0, .08, .20, .40, .80, 2.00}},
    {"mbd_first_mean", Scheme::mbd_first, LoadShape::mean, {0, .04, .10, .20, .38, .73}},
    {"dem_first_end", Scheme::dem_first, LoadShape::end, {1.41, 1.39, 1.37, 1.32, 1.23, 1.00}},
    {"dem_first_mean", Scheme::dem_first, LoadShape::mean, {1.98, 1.96, 1.90, 1.81, 1.64, 1.24}},
};

scene::Coupling coupling(Scheme scheme, LoadShape load, PathShape path = PathShape::linear) {
  scene::Coupling how;
  how.scheme = scheme;
  how.load = load;
  how.path = path;
  how.window = 1e6;  // the length of each window is given where it is advanced
  return how;
}

// Body of mass 1 on a contact with omega = 1.
OscillatorBedParameters wall(double zeta) {
  OscillatorBedParameters bed;
  bed.contact_damping = 2 * zeta;
  return bed;
}

constexpr double round_off = 1e-8;

double measured_limit(CoupledOscillator& oscillator) {
  const auto stable = [&](double s) { return oscillator.growth(s) <= 1 + round_off; };
  double low = 5e-3;
  if (!stable(low)) return 0;
  double high = low;
  while (stable(high *= 1.2)) {
    low = high;
    if (high > 10) return high;
  }
  while (high - low > 1e-3 * low) (stable((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

class Stability : public testing::TestWithParam<Case> {};

TEST_P(Stability, CriticalWindowOnAWall) {
  const Case& c = GetParam();
  for (std::size_t i = 0; i < std::size(zetas); ++i) {
    const scene::Coupling how = coupling(c.scheme, c.load);
    CoupledOscillator oscillator({}, wall(zetas[i]), how, i % 2 ? Channel::shm : Channel::inproc);
    const double measured = measured_limit(oscillator), formula = launch::critical_omega_H(how, zetas[i]);
    std::printf(
        "  %-15s zeta %.2f  critical omega H: expected %.2f  measured %.4f  tolerance 5 %%   window map "
        "%.4f\n",
        c.name, zetas[i], c.critical[i], measured, formula);
    EXPECT_NEAR(measured, c.critical[i], 0.05 * c.critical[i] + 5e-3) << "two decimals are given";
    EXPECT_NEAR(measured, formula, 5e-3 * formula + 5e-3);
    if (measured == 0) {
      EXPECT_GT(oscillator.growth(0.05), 1) << "no window is stable";
      continue;
    }
    EXPECT_LE(oscillator.growth(0.98 * measured), 1 + round_off);
    EXPECT_GT(oscillator.growth(1.02 * measured), 1 + round_off);
  }
}

// What the spectral radius says is what a run does.
TEST_P(Stability, ARunDivergesAboveAndDecaysBelow) {
  const Case& c = GetParam();
  const double zeta = 0.2;
  const scene::Coupling how = coupling(c.scheme, c.load);
  const double limit = launch::critical_omega_H(how, zeta);
  for (const double factor : {0.9, 1.1}) {
    const double s = factor * limit, growth = launch::growth(how, s, zeta);
    const int windows =
        std::min(20000, static_cast<int>(std::ceil(std::log(50.0) / std::abs(std::log(growth)))));
    CoupledOscillator oscillator({}, wall(zeta), how);
    oscillator.body.x = 1;
    double largest = 0;
    for (int i = 0; i < windows; ++i) {
      oscillator.advance(s);
      if (i > windows - 40) largest = std::max(largest, std::abs(oscillator.body.x));
    }
    std::printf("  %-15s zeta %.2f  omega H = %.2f x critical: from 1 to %.2e m in %d windows\n", c.name,
                zeta, factor, largest, windows);
    if (factor > 1)
      EXPECT_GT(largest, 5);
    else
      EXPECT_LT(largest, 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Stability, testing::ValuesIn(cases),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

// The schemes of second order and the implicit ones have no table in the literature: they are held to the
// map.
TEST(StabilityOfTheOthers, AgreesWithTheWindowMap) {
  struct Other {
    const char* name;
    Scheme scheme;
    LoadShape load;
    PathShape path;
  };
  for (const Other& o :
       {Other{"dem_first, quadratic path", Scheme::dem_first, LoadShape::mean, PathShape::quadratic},
        Other{"dem_first, second order", Scheme::dem_first, LoadShape::linear, PathShape::quadratic},
        Other{"linear_implicit", Scheme::linear_implicit, LoadShape::mean, PathShape::linear},
        Other{"implicit", Scheme::implicit, LoadShape::mean, PathShape::linear},
        Other{"implicit, linear load", Scheme::implicit, LoadShape::linear, PathShape::linear}})
    for (const double zeta : zetas) {
      scene::Coupling how = coupling(o.scheme, o.load, o.path);
      how.iteration = scene::Iteration{{.length = 1e-14, .max_iterations = 100, .tolerance = 1e-12}};
      if (o.scheme != Scheme::implicit) how.iteration.reset();
      CoupledOscillator oscillator({}, wall(zeta), how);
      const double formula = launch::critical_omega_H(how, zeta);
      // A map is measured where it is used, not at its limit: in between the two are as near as their limits.
      for (const double s : {0.3, 1.0, 3.0, 8.0}) {
        const double expected = launch::growth(how, s, zeta), measured = oscillator.growth(s);
        EXPECT_NEAR(measured, expected, 1e-3 * expected)
            << o.name << ", omega H = " << s << ", zeta = " << zeta;
      }
      std::printf("  %-26s zeta %.2f  critical omega H: %.3f\n", o.name, zeta, formula);
    }
}

// The body stands on a spring and damper of the bodies' side, of 0.3 to 30 times the frequency of the
// contact.
TEST(StabilityOnASupport, AgreesWithTheWindowMap) {
  double worst = 0;
  for (const Scheme scheme :
       {Scheme::parallel, Scheme::mbd_first, Scheme::dem_first, Scheme::linear_implicit, Scheme::implicit})
    for (const LoadShape load : {LoadShape::mean, LoadShape::linear})
      for (const double frequency : {0.3, 3.0, 30.0}) {
        const bool linear = load == LoadShape::linear;
        if (linear && scheme != Scheme::dem_first && scheme != Scheme::implicit) continue;
        scene::Coupling how = coupling(
            scheme, load, linear && scheme == Scheme::dem_first ? PathShape::quadratic : PathShape::linear);
        if (scheme == Scheme::implicit)
          how.iteration = scene::Iteration{{.length = 1e-14, .max_iterations = 100, .tolerance = 1e-12}};
        const double zeta = 0.1;
        const launch::Support support{frequency * frequency, 2 * 0.05 * frequency};
        CoupledOscillator oscillator({1, support.stiffness, support.damping}, wall(zeta), how);
        for (const double s : {0.1, 0.5, 1.0, 2.0}) {
          const double expected = launch::growth(how, s, zeta, support), measured = oscillator.growth(s);
          worst = std::max(worst, std::abs(measured / expected - 1));
          EXPECT_NEAR(measured, expected, 1e-3 * expected)
              << launch::name(scheme) << ", omega H = " << s << ", support " << frequency;
        }
      }
  const scene::Coupling how = coupling(Scheme::dem_first, LoadShape::mean);
  for (const double frequency : {0.3, 1.0, 3.0, 10.0, 30.0})
    std::printf("  dem_first, zeta 0.1, support of %4.1f omega, zeta 0.05: stable up to omega H = %.3f\n",
                frequency, launch::critical_omega_H(how, 0.1, {frequency * frequency, 0.1 * frequency}));
  std::printf("  growth per window: largest relative difference %.1e  tolerance 1e-3\n", worst);
}

}  // namespace stability_test
}  // namespace tandem::test
