#include "sph_server/io/wall_meshes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/mass_properties.hpp"

namespace tandem::sph {
namespace {

constexpr double pi = std::numbers::pi;
double volume(const TriangleMesh& mesh) {
  return mass_of_mesh(mesh, 1).mass;
}

TEST(WallMeshes, RoundShapesKeepTheirVolumeWithinTheDeviation) {
  for (const double deviation : {1e-4, 1e-3, 0.01}) {
    scene::CylinderShape cylinder;
    cylinder.radius = 0.1;
    cylinder.height = 0.3;
    const FacetedShape tank = faceted(cylinder, {}, deviation);
    EXPECT_NEAR(volume(tank.mesh), pi * 0.003, 1e-12);
    EXPECT_LE(tank.deviation, deviation);
    for (const Vec3d& v : tank.mesh.vertices)
      EXPECT_LE(std::hypot(v.x, v.y), 0.1 + tank.deviation * (1 + 1e-9));
    EXPECT_GE(std::cos(pi / tank.segments) * (0.1 + tank.deviation), 0.1 - deviation) << "middle of a face";
    scene::SphereShape sphere;
    sphere.radius = 0.1;
    const FacetedShape ball = faceted(sphere, deviation);
    EXPECT_NEAR(volume(ball.mesh), 4e-3 * pi / 3, 1e-12);
    EXPECT_LE(ball.deviation, deviation);
  }
}

TEST(WallMeshes, APrismIsWhatItsSegmentsSay) {
  scene::CylinderShape prism;
  prism.radius = 0.1;
  prism.height = 0.3;
  prism.segments = 96;
  const FacetedShape mesh = faceted(prism, {"+z"}, 0.01);
  EXPECT_EQ(mesh.segments, 96);
  EXPECT_EQ(mesh.mesh.triangles.size(), 3u * 96);
  EXPECT_EQ(mesh.deviation, 0);
}

TEST(WallMeshes, OfTheLiquidAreCoarseAndSaySo) {
  scene::Sph sph;
  sph.spacing = 0.02;
  scene::Wall wall;
  wall.name = "tank";
  wall.shape = scene::MeshShape{};
  sph.walls = {wall};
  std::vector<std::string> sentences;
  const TriangleMesh fine = cylinder_mesh(0.1, 0.3, 120);
  const auto coarse = wall_meshes(sph, {{"other", fine}, {"tank", fine}}, sentences);
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_EQ(coarse[0].name, "tank");
  EXPECT_LT(coarse[0].mesh.triangles.size(), 120u);
  EXPECT_NEAR(volume(coarse[0].mesh), volume(fine), 1e-12);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_EQ(sentences[0].find("details of wall 'tank' below "), 0u) << sentences[0];
  sph.wall_deviation = 1e-4;
  sentences.clear();
  EXPECT_EQ(wall_meshes(sph, {{"tank", fine}}, sentences)[0].mesh.triangles.size(), fine.triangles.size());
  EXPECT_TRUE(sentences.empty());
}

}  // namespace
}  // namespace tandem::sph
