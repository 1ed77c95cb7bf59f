#include "common/math/rotation.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace tandem {
namespace {

constexpr double pi = std::numbers::pi;

void expect_near(Vec3d a, Vec3d b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Rotation, QuarterTurnAboutZTakesXToY) {
  const Quat q = exp({0, 0, pi / 2});
  expect_near(q.rotate({1, 0, 0}), {0, 1, 0}, 1e-15);
  expect_near(q.matrix() * Vec3d{1, 0, 0}, {0, 1, 0}, 1e-15);
  expect_near(q.matrix().transpose_times({0, 1, 0}), {1, 0, 0}, 1e-15);
}

TEST(Rotation, ProductAppliesTheRightFactorFirst) {
  const Quat a = exp({0.3, -0.2, 0.7}), b = exp({-1.1, 0.4, 0.2});
  const Vec3d v{1, 2, 3};
  expect_near((a * b).rotate(v), a.rotate(b.rotate(v)), 1e-14);
  expect_near((a * a.conjugate()).rotate(v), v, 1e-14);
}

TEST(Rotation, ExpAndRotationVectorAreInverse) {
  for (const double angle : {0.0, 1e-300, 1e-12, 0.9e-4, 1.1e-4, 1e-2, 1.0, 3.0, pi - 1e-9}) {
    const Vec3d phi = angle * normalized(Vec3d{1, -2, 0.5});
    expect_near(rotation_vector(exp(phi)), phi, 1e-15 + 4e-16 * angle);
  }
}

TEST(Rotation, RotationVectorIsTheShorterWay) {
  const Vec3d phi = rotation_vector(exp({0, 0, 1.5 * pi}));
  expect_near(phi, {0, 0, -0.5 * pi}, 1e-14);
}

TEST(Rotation, ExpOfTinyVectorIsUnit) {
  for (const double angle : {0.0, 1e-200, 1e-9, 1e-5, 1e-4, 1e-3}) {
    const Quat q = exp({angle, 0, 0});
    EXPECT_NEAR(q.norm2(), 1, 1e-15);
    EXPECT_NEAR(q.x, std::sin(angle / 2), 1e-16 * angle + 1e-320);
  }
}

TEST(Vec3, Products) {
  const Vec3d a{1, 2, 3}, b{-4, 5, 6};
  EXPECT_EQ(dot(a, b), 24);
  EXPECT_EQ(cross(a, b), (Vec3d{-3, -18, 13}));
  EXPECT_EQ(norm(Vec3d{2, 3, 6}), 7);
  EXPECT_EQ(a - 2.0 * b, (Vec3d{9, -8, -9}));
  EXPECT_FALSE(is_finite(Vec3d{0, NAN, 0}));
  EXPECT_FALSE(is_finite(Vec3d{0, 0, INFINITY}));
}

}  // namespace
}  // namespace tandem
