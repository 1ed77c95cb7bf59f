// Cylinders, discs and balls without triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/dem_geometry/walls.hpp"

namespace tandem::particles::test {
namespace {

using std::numbers::pi;

scene::CylinderShape round_cylinder(double radius, double height, std::vector<std::string> open = {}) {
  return {radius, height, {}, std::move(open)};
}

const Pose askew{{0.3, -0.2, 0.5}, exp({0.4, -1.1, 0.7})};

Vec3d in_wall(Vec3d p) {
  return askew.q_WB.conjugate().rotate(p - askew.p_WB);
}

// Properties of every contact: the distance is the given one, and point, normal and gap are consistent.
void expect_contact(const std::vector<WallContact>& found, Vec3d p, double radius, double distance) {
  ASSERT_EQ(found.size(), distance < radius ? 1u : 0u) << distance << " of " << radius;
  if (found.empty()) return;
  ASSERT_NEAR(found[0].gap, distance - radius, 1e-14);
  ASSERT_NEAR(norm(found[0].normal), 1, 1e-15);
  ASSERT_NEAR(norm(found[0].point + (found[0].gap + radius) * found[0].normal - p), 0, 1e-14);
}

TEST(RoundCylinder, IsTheDistanceFromItsSideAndRims) {
  const Surface s = surface_of({wall("tube", round_cylinder(1, 1.6, {"+z", "-z"}), ground, askew)}, 0.5);
  ASSERT_EQ(s.facets.size(), 1u);
  Random random(3);
  int contacts_found = 0, at_rim = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p = askew.p_WB + random.vector(-1.6, 1.6), q = in_wall(p);
    const double radius = random(0.05, 0.5), beyond = std::fmax(std::abs(q.z) - 0.8, 0);
    const double distance = std::hypot(std::hypot(q.x, q.y) - 1, beyond);
    if (std::abs(distance - radius) < 1e-12) continue;
    const auto found = contacts(s, p, radius);
    expect_contact(found, p, radius, distance);
    if (HasFatalFailure()) return;
    contacts_found += found.empty() ? 0 : 1;
    at_rim += !found.empty() && beyond > 0 ? 1 : 0;
  }
  EXPECT_GT(contacts_found, 4000);
  EXPECT_GT(at_rim, 500);
}

TEST(RoundCylinder, WithoutHeightIsEndless) {
  const Surface s = surface_of({wall("bore", scene::CylinderShape{0.3, {}, {}, {}})}, 0.1);
  ASSERT_EQ(s.facets.size(), 1u);
  for (const double z : {-1e6, 0.0, 1e6}) {
    expect_contact(contacts(s, {0.25, 0, z}, 0.1), {0.25, 0, z}, 0.1, 0.05);
    expect_contact(contacts(s, {0, -0.35, z}, 0.1), {0, -0.35, z}, 0.1, 0.05);
    EXPECT_TRUE(contacts(s, {0, 0, z}, 0.1).empty());
  }
  EXPECT_FALSE(std::isfinite(s.body_extent[0]));
}

TEST(RoundCylinder, SphereOnTheAxisOfABoreTooNarrowIsPushedSomewhere) {
  const Surface s = surface_of({wall("bore", scene::CylinderShape{0.05, {}, {}, {}}, ground, askew)}, 0.1);
  const auto found = contacts(s, askew.p_WB, 0.1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, -0.05, 1e-15);
  EXPECT_NEAR(dot(found[0].normal, askew.q_WB.rotate({0, 0, 1})), 0, 1e-15);
}

TEST(RoundCylinder, SideAndEndAreTwoContactsInsideAndOneAtTheRim) {
  const Surface s = surface_of({wall("can", round_cylinder(1, 2), ground, askew)}, 0.3);
  EXPECT_EQ(s.patches.size(), 3u);
  const auto at = [&](double x, double y, double z) { return askew.p_WB + askew.q_WB.rotate({x, y, z}); };
  for (int i = 0; i < 100; ++i) {
    const double a = 2 * pi * i / 100, r = 0.2;
    const auto corner = contacts(s, at(0.81 * std::cos(a), 0.81 * std::sin(a), -0.83), r);
    ASSERT_EQ(corner.size(), 2u);  // deepest first: the bottom, then the side
    EXPECT_NEAR(corner[0].gap, 0.17 - r, 1e-14);
    EXPECT_NEAR(corner[1].gap, 0.19 - r, 1e-14);
    EXPECT_NEAR(norm(corner[0].normal - askew.q_WB.rotate({0, 0, 1})), 0, 1e-14);
    EXPECT_NEAR(norm(corner[1].normal - askew.q_WB.rotate({-std::cos(a), -std::sin(a), 0})), 0, 1e-14);
    // Outside, at the rim: the same circle ends both.
    const Vec3d over = at(1.1 * std::cos(a), 1.1 * std::sin(a), 1.1);
    expect_contact(contacts(s, over, r), over, r, std::sqrt(0.02));
    const Vec3d top = at(0.95 * std::cos(a), 0.95 * std::sin(a), 1.15);
    expect_contact(contacts(s, top, r), top, r, 0.15);
  }
}

TEST(RoundCylinder, NameStaysOnTheRim) {
  const Surface s = surface_of({wall("can", round_cylinder(1, 2))}, 0.3);
  Random random(9);
  const std::uint32_t name = contacts(s, {1.1, 0, 1.1}, 0.2).at(0).patch;
  for (int i = 0; i < 1000; ++i)
    ASSERT_EQ(contacts(s, Vec3d{1.1, 0, 1.1} + random.vector(-1e-3, 1e-3), 0.2).at(0).patch, name) << i;
}

TEST(RoundCylinder, EndIsTheDiscThatAPlaneContinues) {
  // A round table flush with the floor around it, which is another wall: one contact wherever the sphere is.
  const Surface s = surface_of({wall("table", round_cylinder(1, 2), ground, {{0, 0, -1}, {}}),
                                wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}})},
                               0.2);
  for (const double x : {0.0, 0.5, 0.93, 1.0, 1.05, 3.0}) {
    const auto found = contacts(s, {x, 0, 0.09}, 0.1);
    ASSERT_EQ(found.size(), 1u) << x;
    EXPECT_NEAR(found[0].gap, -0.01, 1e-15);
    EXPECT_NEAR(found[0].normal.z, 1, 1e-15);
  }
}

TEST(RoundSphere, IsTheDistanceFromInsideAndOutside) {
  const Surface s = surface_of({wall("ball", scene::SphereShape{0.7}, ground, askew)}, 0.4);
  Random random(5);
  int inside = 0, outside = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3d p = askew.p_WB + random.vector(-1, 1);
    const double radius = random(0.05, 0.4), from_centre = norm(p - askew.p_WB);
    const double distance = std::abs(from_centre - 0.7);
    if (std::abs(distance - radius) < 1e-12) continue;
    expect_contact(contacts(s, p, radius), p, radius, distance);
    if (HasFatalFailure()) return;
    if (distance < radius) ++(from_centre < 0.7 ? inside : outside);
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

TEST(RoundSphere, CutByAPlaneHasTwoContactsWhereTheyMeet) {
  // The bottom of a bowl with a flat floor: inside it the sphere has contacts with both.
  const Surface s = surface_of(
      {wall("bowl", scene::SphereShape{1}), wall("floor", scene::PlaneShape{{0, 0, -0.5}, {0, 0, 1}})}, 0.2);
  // Centre 0.09 above the floor and 0.91 from the centre of the bowl.
  const double z = -0.41, x = std::sqrt(0.91 * 0.91 - z * z);
  EXPECT_EQ(contacts(s, {x, 0, z}, 0.1).size(), 2u);
}

TEST(RoundWalls, BoundHowFarTheyReach) {
  const auto extent = [](auto shape, Pose pose) {
    return surface_of({wall("w", shape, BodyId{2}, pose)}, 0.1).body_extent[1];
  };
  EXPECT_DOUBLE_EQ(extent(scene::SphereShape{0.7}, {{3, 4, 0}, {}}), 5.7);
  EXPECT_DOUBLE_EQ(extent(round_cylinder(3, 8), {}), 5);
}

}  // namespace
}  // namespace tandem::particles::test
