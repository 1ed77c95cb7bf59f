// Parts of walls that sensors of pressure cut out.
#include "sph_server/io/patches.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace tandem::test {
namespace patches_test {

using namespace sph;

TEST(Patches, AreCutOutOfAMesh) {
  const TriangleMesh box = box_mesh({2, 2, 2});
  // Through an edge of the box, turned about the normal of the face x = 1.
  const Pose pose{{1, 0.9, 0.2}, exp(Vec3d{0.5, 0, 0}) * exp(Vec3d{0, -0.5 * std::numbers::pi, 0})};
  const CutMesh cut = cut_by_box(box, pose, {0.4, 0.6, 0.6});
  const auto area = [](const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles)
      sum += 0.5 * norm(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]],
                              mesh.vertices[t[2]] - mesh.vertices[t[0]]));
    return sum;
  };
  EXPECT_GT(area(cut.inside), 0.1);
  EXPECT_NEAR(area(cut.inside) + area(cut.outside), 24, 1e-12);
  EXPECT_EQ(cut.inside.triangles.size(), cut.inside_of.size());
  EXPECT_EQ(cut.outside.triangles.size(), cut.outside_of.size());
  // Clear of edges it is the rectangle.
  const CutMesh clear = cut_by_box(box, {{1, 0.1, 0.2}, pose.q_WB}, {0.4, 0.6, 0.6});
  EXPECT_NEAR(area_along(clear.inside, {1, 0, 0}), 0.24, 1e-12);
  EXPECT_TRUE(cut_by_box(box, {{0, 0, 0}, pose.q_WB}, {0.4, 0.6, 0.6}).inside.triangles.empty());
}

}  // namespace patches_test
}  // namespace tandem::test
