#include "coordinator/mesh_import/mesh_facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem::launch {
namespace {

TriangleMesh shifted(TriangleMesh mesh, Vec3d by) {
  for (Vec3d& vertex : mesh.vertices) vertex += by;
  return mesh;
}

// The triangles of both, without common vertices.
TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + offset, j + offset, k + offset});
  return a;
}

TEST(MeshFacts, OfAClosedBox) {
  // Far from the origin: nothing may cancel.
  const MeshFacts facts = facts_of(shifted(box_mesh({2, 4, 6}), {1e6, -1e6, 1e6}));
  EXPECT_EQ(facts.triangles, 12u);
  EXPECT_NEAR(norm(facts.size() - Vec3d{2, 4, 6}), 0, 1e-9);
  EXPECT_NEAR(facts.area, 2 * (8 + 12 + 24), 1e-8);
  EXPECT_EQ(facts.open_edges, 0u);
  EXPECT_EQ(facts.non_manifold_edges, 0u);
  EXPECT_EQ(facts.inverted_edges, 0u);
  EXPECT_TRUE(facts.openings.empty());
  ASSERT_TRUE(facts.volume);
  EXPECT_NEAR(*facts.volume, 48, 1e-7);
}

TEST(MeshFacts, ABoxInsideOutHasANegativeVolume) {
  TriangleMesh mesh = box_mesh({2, 4, 6});
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(facts_of(mesh).volume.value(), -48, 1e-12);
  EXPECT_EQ(facts_of(mesh).inverted_edges, 0u);
}

TEST(MeshFacts, OneTriangleTurnedOver) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const MeshFacts facts = facts_of(mesh);
  EXPECT_EQ(facts.inverted_edges, 3u);
  EXPECT_EQ(facts.open_edges, 0u);
  EXPECT_FALSE(facts.volume);
}

TEST(MeshFacts, AMissingTriangle) {
  TriangleMesh mesh = box_mesh({3, 4, 5});
  mesh.triangles.pop_back();  // a right triangle with sides of 3 and 4 on top
  const MeshFacts facts = facts_of(mesh);
  EXPECT_EQ(facts.open_edges, 3u);
  ASSERT_EQ(facts.openings.size(), 1u);
  const Opening& hole = facts.openings[0];
  EXPECT_EQ(hole.edges, 3u);
  EXPECT_DOUBLE_EQ(hole.length, 12);
  EXPECT_DOUBLE_EQ(hole.extent, 5);
  EXPECT_DOUBLE_EQ(hole.width, 2) << "4 x 6 / 12, the diameter of the inscribed circle";
  EXPECT_DOUBLE_EQ(hole.at.z, 2.5);
  EXPECT_FALSE(facts.volume);
  EXPECT_EQ(facts.unjoined_edges, 0u);
}

TEST(MeshFacts, APipeHasTwoOpenings) {
  const MeshFacts facts = facts_of(cylinder_mesh(0.5, 3, 64, {"-z", "+z"}));
  EXPECT_EQ(facts.open_edges, 128u);
  ASSERT_EQ(facts.openings.size(), 2u);
  for (const Opening& end : facts.openings) {
    EXPECT_EQ(end.edges, 64u);
    EXPECT_NEAR(end.length, std::numbers::pi, 0.002);
    EXPECT_NEAR(end.width, 1, 0.002);
  }
}

TEST(MeshFacts, AThirdTriangleAtAnEdge) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.vertices.push_back({2, 2, 2});
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], 8});
  const MeshFacts facts = facts_of(mesh);
  EXPECT_EQ(facts.non_manifold_edges, 1u);
  EXPECT_EQ(facts.open_edges, 2u);
}

TEST(MeshFacts, TwoHalvesThatAreNotJoined) {
  const TriangleMesh lower = shifted(box_mesh({1, 1, 1}, {"+z"}), {0, 0, -0.5});
  const auto with_gap = [&](double gap) {
    return facts_of(together(lower, shifted(box_mesh({1, 1, 1}, {"-z"}), {0, 0, 0.5 + gap})));
  };
  const MeshFacts seam = with_gap(1e-6);
  EXPECT_EQ(seam.open_edges, 0u);
  EXPECT_EQ(seam.unjoined_edges, 8u);
  EXPECT_NEAR(seam.volume.value(), 2, 1e-5);
  EXPECT_NEAR(seam.widest_gap, 1e-6, 1e-12);
  EXPECT_NEAR(seam.unjoined_at.z, 0, 2e-6);
  const MeshFacts apart = with_gap(1e-3);
  EXPECT_EQ(apart.open_edges, 8u);
  EXPECT_EQ(apart.openings.size(), 2u);
  EXPECT_EQ(apart.unjoined_edges, 0u) << "so far apart two openings are meant";
}

TEST(MeshFacts, AHoleThatMeetsARimAtACornerIsAnOpeningOfItsOwn) {
  TriangleMesh mesh = cylinder_mesh(0.5, 1, 16, {"+z"});
  // The side consists of quads from the ring below (0 to 15) to the one above; this triangle has one corner
  // at the rim.
  const std::array<std::uint32_t, 3> gone{3, 4, 20};
  const auto at = std::find(mesh.triangles.begin(), mesh.triangles.end(), gone);
  ASSERT_NE(at, mesh.triangles.end());
  mesh.triangles.erase(at);
  const MeshFacts facts = facts_of(mesh);
  EXPECT_EQ(facts.open_edges, 19u);
  ASSERT_EQ(facts.openings.size(), 2u);
  EXPECT_EQ(facts.openings[0].edges, 16u);
  EXPECT_NEAR(facts.openings[0].width, 1, 0.03);
  EXPECT_EQ(facts.openings[1].edges, 3u);
}

TEST(MeshFacts, ASeamOfRoundingIsNoOpening) {
  // Like a program that closes a circle by n rotations of 2 pi / n: the last corner differs slightly from
  // the first.
  TriangleMesh mesh = cylinder_mesh(0.5, 1, 16, {"+z"});
  for (auto& t : mesh.triangles)
    if (std::find(t.begin(), t.end(), 15u) != t.end())
      for (auto& v : t)
        if (v == 0 || v == 16) {
          mesh.vertices.push_back(mesh.vertices[v] + Vec3d{0, 1e-16, 0});
          v = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
        }
  const MeshFacts facts = facts_of(mesh);
  ASSERT_EQ(facts.openings.size(), 1u);
  EXPECT_EQ(facts.openings[0].edges, 16u);
  EXPECT_NEAR(facts.openings[0].width, 1, 0.03);
}

}  // namespace
}  // namespace tandem::launch
