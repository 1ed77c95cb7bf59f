// Why linear_implicit does not hand on, one window later, the impulse that it owes: on the model problem of
// docs/coupling.md, in units of m = omega = 1, a share w of what was recorded and not given is added to the
// load of each window,
//   a (1 + s^2 + 2 zeta s) = F + w p / H,   p' = p + H (F - a),   s = omega H.
// With w = 0 it is the scheme as it is, which no window makes unstable.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "common/math/spectral_radius.hpp"

namespace tandem::test {
namespace carry_test {

double growth(double s, double zeta, double w) {
  std::vector<double> map;  // by columns: x, v, p
  for (int i = 0; i < 3; ++i) {
    const double x = i == 0, v = i == 1, p = i == 2, H = s;
    const double F = -(x + v * H / 2) - 2 * zeta * v;  // mean along the predicted path
    const double a = (F + w * p / H) / (1 + s * s + 2 * zeta * s);
    map.insert(map.end(), {x + H * v + H * H / 2 * a, v + H * a, p + H * (F - a)});
  }
  return spectral_radius(map);
}

// The smallest omega H that is lost; infinite where none is, up to 100.
double first_lost(double zeta, double w) {
  for (double s = 0.01; s < 100; s *= 1.02)
    if (growth(s, zeta, w) > 1 + 1e-9) return s;
  return std::numeric_limits<double>::infinity();
}

TEST(CarriedImpulse, CostsTheStabilityThatTheSchemeIsFor) {
  std::printf("  omega H from which the map grows; columns: zeta = 0, .02, .05, .1, .2, .5\n");
  for (const double w : {0.0, 0.005, 0.02, 0.1, 0.5, 1.0}) {
    std::printf("  share %-5g", w);
    for (const double zeta : {0.0, 0.02, 0.05, 0.1, 0.2, 0.5}) {
      const double lost = first_lost(zeta, w);
      std::printf("  %6.2f", lost);
      if (w == 0) {
        EXPECT_TRUE(std::isinf(lost));
      } else if (zeta == 0) {
        EXPECT_LT(lost, 0.1) << "a late spring is a negative damper, however small its share";
      } else if (2 * zeta / w < 90) {
        EXPECT_LT(lost, 1.1 * std::max(1.0, 2 * zeta / w)) << "what is carried must stay below the damping";
      }
    }
    std::printf("\n");
  }
}

}  // namespace carry_test
}  // namespace tandem::test
