// What is measured of a liquid at a point and on a line.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "sph_server/engine/probe.hpp"

namespace tandem::test {
namespace {

using namespace sph;

constexpr double spacing = 0.1;
const Vec3d gradient{300, -200, -9810};

double linear_pressure(Vec3d x) {
  return 5000 + dot(gradient, x);
}

void expect_probe(const char* what, double expected, double measured, double tolerance) {
  std::printf("%s: expected %.9g, measured %.9g, tolerance %.3g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

// A cubic lattice in [0, 1]^3, up to the level z = 0.6.
struct Pool {
  LiquidState state;
  Liquid liquid;
  particles::Periods periods;
  std::vector<TriangleMesh> meshes;
  Pose pose;  // of all of it

  explicit Pool(const Pose& at = {}) : pose(at) {
    liquid.spacing = spacing;
    liquid.sound_speed = 30;
    for (int k = 0; k < 6; ++k)
      for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 10; ++i) add({(i + 0.5) * spacing, (j + 0.5) * spacing, (k + 0.5) * spacing});
    meshes = {transformed(box_mesh({1, 1, 2}, {"+z"}), Pose{{0.5, 0.5, 1}, {}})};
  }
  void add(Vec3d x) {
    state.position.push_back(in_world(x));
    state.velocity.push_back({});
    state.compression.push_back(0);
    state.pressure.push_back(linear_pressure(x));
    state.slope.push_back(pose.q_WB.rotate(gradient));
  }
  Vec3d in_world(Vec3d x) const { return pose.p_WB + pose.q_WB.rotate(x); }
  Walls walls() const {
    Walls all(meshes, liquid.support());
    for (std::uint32_t b = 0; b < all.bodies(); ++b) all.set_pose(b, {pose.p_WB, pose.q_WB.matrix(), {}, {}});
    return all;
  }
  double pressure(Vec3d x) const {
    const Walls all = walls();
    return Probe(state, liquid, periods, all).pressure_at(in_world(x));
  }
  double level(Vec3d x, Vec3d along = {0, 0, 1}) const {
    const Walls all = walls();
    return Probe(state, liquid, periods, all).level_on(in_world(x), pose.q_WB.rotate(along));
  }
};

TEST(Probe, PressureThatIsLinearIsExactAlsoOnWalls) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(0, 1);
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    const Pool pool(Pose{{at(random), at(random), at(random)},
                         Quat{at(random), at(random), at(random), at(random)}.normalized()});
    for (Vec3d x : {Vec3d{at(random), at(random), 0.6 * at(random)}, Vec3d{0, at(random), 0.2},
                    Vec3d{0, 0, 0}, Vec3d{at(random), at(random), 0}})
      worst = std::max(worst, std::fabs(pool.pressure(x) - linear_pressure(x)));
  }
  expect_probe("largest error of a linear pressure [Pa]", 0, worst, 1e-6);
  EXPECT_EQ(Pool().pressure({0.5, 0.5, 1.2}), 0) << "there is no liquid";
}

TEST(Probe, PressureIsThatOfItsSideOfASheet) {
  Pool pool;
  pool.meshes.push_back({{{0.5, 0, 0}, {0.5, 1, 0}, {0.5, 1, 2}, {0.5, 0, 2}}, {{0, 1, 2}, {0, 2, 3}}});
  for (std::size_t i = 0; i < pool.state.size(); ++i) {
    pool.state.pressure[i] = pool.state.position[i].x < 0.5 ? 1000 : 3000;
    pool.state.slope[i] = {};
  }
  expect_probe("a tenth of a spacing before the sheet [Pa]", 1000, pool.pressure({0.49, 0.5, 0.3}), 1e-9);
  expect_probe("behind it", 3000, pool.pressure({0.51, 0.5, 0.3}), 1e-9);
  expect_probe("on it: the mean", 2000, pool.pressure({0.5, 0.5, 0.3}), 1e-9);
}

TEST(Probe, LevelIsThatOfTheSurface) {
  const Pool pool;
  expect_probe("in the middle [m]", 0.6, pool.level({0.52, 0.47, 0}), 0.1 * spacing);
  expect_probe("from a point in the liquid", 0.4, pool.level({0.52, 0.47, 0.2}), 0.1 * spacing);
  expect_probe("a fifth of a spacing from a side", 0.6, pool.level({0.02, 0.5, 0}), 0.2 * spacing);
  expect_probe("and from two", 0.6, pool.level({0.02, 0.03, 0}), 0.4 * spacing);
  const double slanted = pool.level({0.5, 0.5, 0}, normalized(Vec3d{0.2, 0, 1}));
  expect_probe("on a slanted line", 0.6 * std::sqrt(1.04), slanted, 0.12 * spacing);
  EXPECT_EQ(pool.level({2, 2, 0}), 0) << "no liquid on the line";
  const Pool turned(Pose{{3, 1, 2}, Quat{0.3, -0.5, 0.7, 0.2}.normalized()});
  expect_probe("turned with all that is there", pool.level({0.52, 0.47, 0}), turned.level({0.52, 0.47, 0}),
               1e-6);
}

TEST(Probe, ADropAboveTheSurfaceIsNoLevel) {
  Pool pool;
  pool.add({0.55, 0.45, 1.3});
  expect_probe("level below a drop [m]", 0.6, pool.level({0.52, 0.47, 0}), 0.1 * spacing);
}

}  // namespace
}  // namespace tandem::test
