#include "common/math/spectral_radius.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tandem {
namespace {

// A rotation by any angle, stretched by 1.7, has the eigenvalues 1.7 exp(+-i angle); the third one is -0.9.
TEST(SpectralRadius, OfAStretchedTurn) {
  const double c = 1.7 * std::cos(0.4), s = 1.7 * std::sin(0.4);
  const std::vector<double> matrix = {c, s, 0, -s, c, 0, 0, 0, -0.9};
  EXPECT_NEAR(spectral_radius(matrix), 1.7, 1e-14);
}

// Powers of a nilpotent matrix vanish, however large its elements.
TEST(SpectralRadius, OfANilpotentMatrixIsZero) {
  EXPECT_EQ(spectral_radius(std::vector<double>{0, 1e6, 0, 0}), 0);
}

TEST(SpectralRadius, OfANegativeNumberIsItsModulus) {
  EXPECT_EQ(spectral_radius(std::vector<double>{-3}), 3);
}

}  // namespace
}  // namespace tandem
