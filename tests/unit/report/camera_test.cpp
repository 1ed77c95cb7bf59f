#include "coordinator/report/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tandem::launch {
namespace {

Frame box(Vec3d centre, Vec3d size) {
  Frame frame;
  frame.surfaces.push_back({"box", true, transformed(box_mesh(size), {centre, {}})});
  return frame;
}

struct Screen {
  double x = 0, y = 0;  // 1 is the edge of the picture [-]
};

Screen seen(const scene::Camera& camera, Vec3d point, double aspect) {
  const Vec3d view = normalized(camera.target - camera.eye);
  const Vec3d right = normalized(cross(view, camera.up)), top = cross(right, view);
  const double slope = std::tan(0.5 * camera.field_of_view * std::numbers::pi / 180);
  const Vec3d p = point - camera.eye;
  const double depth = dot(p, view);
  EXPECT_GT(depth, 0);
  return {dot(p, right) / (depth * slope), dot(p, top) / (depth * slope / aspect)};
}

void expect_framed(const Frame& frame, Vec3d up) {
  const double aspect = 16.0 / 9;
  const scene::Camera camera = automatic_camera(frame, up, aspect);
  double widest = 0;
  for (const Vec3d& vertex : frame.surfaces[0].mesh.vertices) {
    const Screen at = seen(camera, vertex, aspect);
    widest = std::max({widest, std::abs(at.x), std::abs(at.y)});
  }
  EXPECT_LE(widest, 1) << "cut off";
  EXPECT_GE(widest, 0.8) << "lost in the picture";
  EXPECT_GT(dot(camera.eye - camera.target, up), 0) << "seen from above";
}

TEST(Camera, FramesWhateverIsThere) {
  for (const Vec3d size :
       {Vec3d{1, 1, 1}, Vec3d{10, 1, 1}, Vec3d{1, 10, 1}, Vec3d{1, 1, 10}, Vec3d{1e-3, 2e-3, 1e-3}}) {
    expect_framed(box({5, -3, 2}, size), {0, 0, 1});
    expect_framed(box({5, -3, 2}, size), {0, 1, 0});
  }
}

TEST(Camera, LooksAtTheBroadSide) {
  const auto turned = [](Vec3d size) {
    const scene::Camera camera = automatic_camera(box({}, size), {0, 0, 1}, 16.0 / 9);
    const Vec3d view = camera.target - camera.eye;
    return std::abs(view.x) > std::abs(view.y);
  };
  EXPECT_FALSE(turned({4, 1, 1}));
  EXPECT_TRUE(turned({1, 4, 1}));
}

TEST(Camera, UpIsAgainstGravity) {
  scene::Scene scene;
  scene.gravity = {0, -3, 0};
  EXPECT_EQ(upwards(scene), (Vec3d{0, 1, 0}));
  scene.gravity = {};
  EXPECT_EQ(upwards(scene), (Vec3d{0, 0, 1}));
}

}  // namespace
}  // namespace tandem::launch
