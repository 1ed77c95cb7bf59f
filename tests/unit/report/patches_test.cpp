// Smooth parts of surfaces, and what they hide: a container is transparent, what is in it or beside it is
// not.
#include "coordinator/report/patches.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace tandem::launch {
namespace {

// 27 grains in a cube of edge 0.6 about the origin.
Frame grains() {
  Frame frame;
  for (const double x : {-.3, 0., .3})
    for (const double y : {-.3, 0., .3})
      for (const double z : {-.3, 0., .3}) {
        frame.position.insert(frame.position.end(), {x, y, z});
        frame.radius.push_back(.1);
        frame.value.push_back(0);
      }
  return frame;
}

std::vector<double> clearness(const TriangleMesh& mesh, const Frame& frame, Vec3d eye) {
  std::vector<Patch> patches = patches_of(mesh);
  count_hidden(patches, mesh, points_to_see(frame), eye);
  std::vector<double> found;
  for (const Patch& patch : patches) found.push_back(clearness_of(patch.hidden, false));
  std::ranges::sort(found);
  return found;
}

TEST(Patches, AreTheSmoothPartsOfASurface) {
  EXPECT_EQ(patches_of(box_mesh({1, 2, 3})).size(), 6u);
  EXPECT_EQ(patches_of(cylinder_mesh(1, 2, 48)).size(), 3u) << "its side and its ends";
  EXPECT_EQ(patches_of(cylinder_mesh(1, 2, 48, {"+z"})).size(), 2u);
  EXPECT_EQ(patches_of(sphere_mesh(1, 48)).size(), 1u);
  std::size_t triangles = 0;
  for (const Patch& patch : patches_of(box_mesh({1, 2, 3}))) triangles += patch.triangles.size();
  EXPECT_EQ(triangles, 12u);
}

// From the front only the front of a box is before the grains.
TEST(Patches, TheFrontOfAContainerIsClearAndItsBackIsSolid) {
  const std::vector<double> box = clearness(box_mesh({1, 1, 1}, {"+z"}), grains(), {0, -10, 0});
  ASSERT_EQ(box.size(), 5u);
  EXPECT_GT(box[4], 0.8);
  EXPECT_EQ(box[3], 0);
}

TEST(Patches, AMachineInFrontOfSomeGrainsIsSolid) {
  const TriangleMesh lever = transformed(box_mesh({.05, .05, 1}), {{.45, -2, 0}, {}});
  for (const double clear : clearness(lever, grains(), {0, -10, 0})) EXPECT_EQ(clear, 0);
}

TEST(Patches, WithoutParticlesAllIsSolid) {
  for (const double clear : clearness(box_mesh({1, 1, 1}), Frame{}, {0, -10, 0})) EXPECT_EQ(clear, 0);
}

// Of a film no patch changes at once.
TEST(Patches, ClearnessFades) {
  EXPECT_EQ(clearness_of(0.1, false), 0);
  EXPECT_NEAR(clearness_of(0.175, false), 0.46, 1e-12);
  EXPECT_NEAR(clearness_of(0.5, false), 0.92, 1e-12);
  EXPECT_EQ(clearness_of(0.03, true), 0);
  EXPECT_NEAR(clearness_of(0.1, true), 0.92, 1e-12) << "a fixed wall gives way earlier";
}

}  // namespace
}  // namespace tandem::launch
