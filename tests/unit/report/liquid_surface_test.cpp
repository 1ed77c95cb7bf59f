#include "coordinator/report/liquid_surface.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

namespace tandem::launch {
namespace {

constexpr double spacing = 0.01;

// 12^3 particles in a cube around the origin, whose values are their x, and one particle far from them.
Frame cube_and_drop() {
  Frame frame;
  const auto add = [&](double x, double y, double z) {
    frame.position.insert(frame.position.end(), {x, y, z});
    frame.radius.push_back(0.5 * spacing);
    frame.value.push_back(x);
  };
  add(0.5, 0.5, 0.5);  // a grain
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 12; ++k) add((i - 5.5) * spacing, (j - 5.5) * spacing, (k - 5.5) * spacing);
  add(0.2, 0.1, 0);
  frame.liquid = frame.radius.size() - 1;
  return frame;
}

TEST(LiquidSurface, EnclosesTheParticlesAndLeavesDrops) {
  const auto folder = std::filesystem::temp_directory_path() / ("liquid_surface_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const Frame frame = with_liquid_surface(cube_and_drop(), folder);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove_all(folder);

  ASSERT_TRUE(frame.liquid_surface);
  // The grain and the drop are spheres still.
  ASSERT_EQ(frame.radius.size(), 2u);
  EXPECT_EQ(frame.liquid, 1u);
  EXPECT_EQ(frame.centre(0), (Vec3d{0.5, 0.5, 0.5}));
  EXPECT_EQ(frame.centre(1), (Vec3d{0.2, 0.1, 0}));

  const LiquidSurface& surface = *frame.liquid_surface;
  const double side = 12 * spacing;
  double volume = 0;
  for (const auto& [a, b, c] : surface.mesh.triangles) {
    const std::vector<Vec3d>& p = surface.mesh.vertices;
    volume += dot(p[a], cross(p[b], p[c])) / 6;
  }
  double highest = 0, wrong_value = 0, wrong_normal = 0;
  for (std::size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
    const Vec3d p = surface.mesh.vertices[i];
    if (std::abs(p.x) < 0.25 * side && std::abs(p.y) < 0.25 * side && p.z > 0) {
      highest = std::max(highest, std::abs(p.z - 0.5 * side));
      wrong_normal = std::max(wrong_normal, norm(surface.normals[i] - Vec3d{0, 0, 1}));
    }
    wrong_value = std::max(wrong_value, std::abs(surface.value[i] - p.x));
  }
  std::printf(
      "volume %.3e m3 (of the particles %.3e), top face %.2g spacings off, normal %.2g, value %.2g "
      "spacings\n",
      volume, side * side * side, highest / spacing, wrong_normal, wrong_value / spacing);
  EXPECT_NEAR(volume, side * side * side, 0.15 * side * side * side);
  EXPECT_LT(highest, 0.25 * spacing);
  EXPECT_LT(wrong_normal, 0.1);
  EXPECT_LT(wrong_value, 1.2 * spacing);
}

TEST(LiquidSurface, OfAFrameWithoutLiquidIsNone) {
  Frame frame = cube_and_drop();
  frame.liquid = 0;
  EXPECT_FALSE(with_liquid_surface(frame, "/nowhere").liquid_surface);
}

}  // namespace
}  // namespace tandem::launch
