#include "common/geometry/closing.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/mass_properties.hpp"

namespace tandem {
namespace closing_test {

constexpr double tolerance = 1e-3, width = 0.1;

TEST(Closing, OfAClosedMeshIsASolid) {
  EXPECT_EQ(closing_of(box_mesh({1, 2, 3}), tolerance, width).closure, Closure::solid);
}

// As in a file whose triangles have corners of their own, rounded each in another way.
TEST(Closing, JoinsCornersWithinTheTolerance) {
  const TriangleMesh box = box_mesh({1, 2, 3});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> rounding(-0.2e-3, 0.2e-3);
  TriangleMesh loose;
  for (const auto& t : box.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    for (const std::uint32_t v : t)
      loose.vertices.push_back(box.vertices[v] + Vec3d{rounding(random), rounding(random), rounding(random)});
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_FALSE(why_not_solid(loose).empty());
  const Closing closing = closing_of(loose, tolerance, width);
  EXPECT_EQ(closing.closure, Closure::solid);
  EXPECT_EQ(closing.mesh.vertices.size(), 8u);
  EXPECT_NEAR(mass_of_mesh(closing.mesh, 1).mass, 6, 6e-3);
}

TEST(Closing, AcceptsCornersOnEdges) {
  TriangleMesh box = box_mesh({1, 1, 1});
  // One triangle becomes two, whose common corner is on an edge of its neighbour.
  const auto [a, b, c] = box.triangles.front();
  const auto middle = static_cast<std::uint32_t>(box.vertices.size());
  box.vertices.push_back(0.5 * (box.vertices[a] + box.vertices[b]));
  box.triangles.front() = {a, middle, c};
  box.triangles.push_back({middle, b, c});
  EXPECT_FALSE(why_not_solid(box).empty());
  EXPECT_EQ(closing_of(box, tolerance, width).closure, Closure::solid);
}

TEST(Closing, SaysThatTrianglesAreFlipped) {
  TriangleMesh box = box_mesh({1, 1, 1});
  std::swap(box.triangles[4][1], box.triangles[4][2]);
  EXPECT_EQ(closing_of(box, tolerance, width).closure, Closure::flipped);
}

TEST(Closing, DistinguishesSlitsFromOpenings) {
  TriangleMesh box = box_mesh({1, 1, 1});
  const auto [a, b, c] = box.triangles.front();
  const Vec3d A = box.vertices[a], B = box.vertices[b], C = box.vertices[c];
  for (const double hole : {0.05, 0.5}) {
    // The triangle with a hole of its shape about its middle.
    const Vec3d middle = 1.0 / 3 * (A + B + C);
    TriangleMesh holed = box;
    const auto first = static_cast<std::uint32_t>(holed.vertices.size());
    for (const Vec3d corner : {A, B, C}) holed.vertices.push_back(middle + hole * (corner - middle));
    const std::uint32_t outer[] = {a, b, c};
    holed.triangles.erase(holed.triangles.begin());
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t next = (k + 1) % 3;
      holed.triangles.push_back({outer[k], outer[next], first + next});
      holed.triangles.push_back({outer[k], first + next, first + k});
    }
    const Closing closing = closing_of(holed, tolerance, width);
    EXPECT_EQ(closing.closure, hole < 0.1 ? Closure::slit : Closure::open);
    EXPECT_NEAR(closing.width, hole * std::sqrt(0.5), 1e-12);
  }
  EXPECT_EQ(closing_of(box_mesh({1, 1, 1}, {"+z"}), tolerance, width).closure, Closure::open);
}

TEST(Closing, FindsOpeningsWhereTheyCount) {
  const TriangleMesh cup = box_mesh({1, 1, 1}, {"+z"});
  EXPECT_FALSE(openings_of(cup, [](Vec3d x) { return x.z < 0.4; }).widest);
  TriangleMesh box = box_mesh({1, 1, 1});
  box.triangles.erase(box.triangles.begin());
  EXPECT_TRUE(openings_of(box, [](Vec3d x) { return x.z < -0.4; }).widest);
  const Openings openings = openings_of(cup, [](Vec3d) { return true; });
  ASSERT_TRUE(openings.widest);
  EXPECT_NEAR(openings.widest->width, 1, 1e-12);
  EXPECT_FALSE(openings.flipped);
  // A sheet is no solid, whichever way its parts wind.
  TriangleMesh sheet = cup;
  std::swap(sheet.triangles[2][1], sheet.triangles[2][2]);
  EXPECT_EQ(closing_of(sheet, tolerance, width).closure, Closure::open);
}

}  // namespace closing_test
}  // namespace tandem
