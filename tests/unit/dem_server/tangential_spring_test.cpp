// The arithmetic that the contact laws have in common.
#include <gtest/gtest.h>

#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/history.hpp"

namespace tandem::test {
namespace {

// Also for very small springs: squares of lengths have twice the exponent, and the range of single precision
// is small.
TEST(TangentialSpring, KeepsItsLengthWhileThePlaneTurns) {
  dem::Contact<float> c;
  const Vec3f n = c.n = normalized(Vec3f{0.1F, -0.2F, 1});
  for (const float length : {1e-18F, 1e-15F, 1e-12F, 1e-9F, 1e-6F, 1e-3F}) {
    const Vec3f rotate_spring = dem::rotate_spring(Vec3f{length, 0, 0}, c, 1e-7F, 1e-7F);
    EXPECT_NEAR(norm(rotate_spring.as<double>()) / static_cast<double>(length), 1, 3e-7) << length;
    EXPECT_NEAR(dot(rotate_spring.as<double>(), n.as<double>()) / static_cast<double>(length), 0, 1e-7)
        << length;
    EXPECT_NEAR(norm(dem::rotate_spring(Vec3f{length, 0, 0}, c, 1e-7F, 4e-7F).as<double>()) /
                    static_cast<double>(length),
                0.5, 3e-7)
        << length;
  }
  EXPECT_EQ(dem::rotate_spring(Vec3f{1e-25F, 0, 0}, c, 1e-7F, 1e-7F), Vec3f{});
  EXPECT_EQ(dem::rotate_spring(Vec3f{1e-6F, 0, 0}, c, 0.0F, 1e-7F), Vec3f{});  // a new contact
  EXPECT_EQ(dem::rotate_spring(Vec3f{}, c), Vec3f{});
}

TEST(TangentialSpring, KeepsAnyAngleWhileThePlaneTurns) {
  dem::Contact<float> c;
  c.n = normalized(Vec3f{0.1F, -0.2F, 1});
  for (const float angle : {1e-15F, 1e-6F, 1.0F, 1e4F}) {
    const Vec3f rotate_spring =
        dem::rotate_spring(Vec3f{angle, 0, 0}, c, 1.0F, 1.0F, dem::finer_angles<float>);
    EXPECT_NEAR(norm(rotate_spring.as<double>()) / static_cast<double>(angle), 1, 3e-7) << angle;
  }
}

// Each of two spheres in contact evaluates the law itself, and their forces have to be opposite to the bit.
TEST(Coefficients, OfTwoInSeriesAreTheSameFromEitherSide) {
  float a = 1e-6F;
  for (int i = 0; i < 200; ++i, a *= 1.0731F) {
    float b = 1.37e-6F;
    for (int k = 0; k < 200; ++k, b *= 1.0812F) {
      ASSERT_EQ(dem::in_series(a, b), dem::in_series(b, a)) << a << " " << b;
      const double exact = 1 / (1 / static_cast<double>(a) + 1 / static_cast<double>(b));
      ASSERT_NEAR(static_cast<double>(dem::in_series(a, b)) / exact, 1, 2e-7);
    }
  }
}

TEST(TangentialSpring, SlidesAtCoulombsLimitHoweverSmall) {
  for (const float limit : {1e-17F, 1e-12F, 1e-6F, 1.0F, 1e6F}) {
    dem::ContactForce<float> f;
    f.k_t = 1e3F;
    f.c_t = 1;
    Vec3f spring{3 * limit / f.k_t, 0, 0};
    dem::limit_friction(f, Vec3f{0, limit, 0}, limit, spring);
    EXPECT_NEAR(norm(f.tangential.as<double>()) / static_cast<double>(limit), 1, 3e-7);
    EXPECT_NEAR(static_cast<double>(f.k_t) * norm(spring.as<double>()) / static_cast<double>(limit), 1, 3e-7);
    // Within the limit nothing is cut off.
    spring = {limit / 2 / f.k_t, 0, 0};
    dem::limit_friction(f, Vec3f{}, limit, spring);
    EXPECT_EQ(f.tangential, -(f.k_t * spring));
  }
  dem::ContactForce<float> f;
  f.k_t = 1e3F;
  Vec3f spring{1e-6F, 0, 0};
  dem::limit_friction(f, Vec3f{}, 0.0F, spring);
  EXPECT_EQ(f.tangential, Vec3f{});
  EXPECT_EQ(spring, Vec3f{});
}

}  // namespace
}  // namespace tandem::test
