// Ropes and cylinders are drawn between the points of their bodies where these are in the last frame.
#include "coordinator/report/element_rods.hpp"

#include <gtest/gtest.h>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {
namespace {

TEST(ElementRods, FollowTheirBodies) {
  scene::Scene scene;
  scene.mbd.emplace();
  scene::Body& body = scene.mbd->bodies.emplace_back();
  body.name = "load";
  body.pose = {{1, 2, 3}, exp(Vec3d{.3, -.4, .5})};
  const BodyId load{0};
  scene::Rope rope;
  rope.points = {{ground, {0, 0, 9}}, {ground, {1, 0, 9}}, {load, {1, 2, 4}}};
  scene.mbd->forces.push_back(rope);
  scene::Cylinder cylinder;
  cylinder.body_b = load, cylinder.point_a = {0, 0, 0}, cylinder.point_b = {1, 2, 4};
  cylinder.hydraulics.emplace().bore_area = 4e-2 * 3.14159265358979;
  scene.mbd->forces.push_back(cylinder);

  const Pose moved{{5, 1, 7}, exp(Vec3d{-1, .2, 2})};
  const TriangleMesh mesh = box_mesh({1, 2, 3});
  Frame frame;
  Surface& surface = frame.surfaces.emplace_back();
  surface.name = "load";
  for (const Vec3d p : mesh.vertices) surface.mesh.vertices.push_back(moved.p_WB + moved.q_WB.rotate(p));
  surface.frame = placed_frame(mesh.vertices, surface.mesh.vertices);

  const Vec3d hook = moved.p_WB + moved.q_WB.rotate(body.pose.q_WB.conjugate().rotate({0, 0, 1}));
  const std::vector<Rod> rods = element_rods(scene, frame, 10);
  ASSERT_EQ(rods.size(), 4u);
  EXPECT_LT(norm(rods[0].b - Vec3d{1, 0, 9}), 1e-12);
  EXPECT_LT(norm(rods[1].b - hook), 1e-12);
  EXPECT_EQ(rods[2].of, Rod::Of::barrel);
  EXPECT_NEAR(rods[2].radius, .2, 1e-12);
  EXPECT_LT(norm(rods[3].b - hook), 1e-12);

  // All points in a line: the place of the body is not known.
  EXPECT_FALSE(placed_frame({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}));
  frame.surfaces[0].frame.reset();
  EXPECT_EQ(element_rods(scene, frame, 10).size(), 1u);
}

}  // namespace
}  // namespace tandem::launch
