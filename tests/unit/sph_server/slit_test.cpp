// A particle between two walls that are nearer to each other than half a spacing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/equations/wall_repulsion.hpp"

namespace tandem::test {
namespace slit_test {

using namespace sph;

constexpr double a = 0.02;  // spacing [m]

// A square across z, and one that leans by an angle against it, over the point at (x, 0).
TriangleMesh sheet(double z, double angle) {
  TriangleMesh mesh;
  for (const auto& [x, y] :
       {std::pair{-5.0, -5.0}, std::pair{5.0, -5.0}, std::pair{5.0, 5.0}, std::pair{-5.0, 5.0}})
    mesh.vertices.push_back({a * x, a * y, z + a * x * std::tan(angle)});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// Speed over that of sound, of a particle that starts off the middle at rest.
struct Speed {
  double largest = 0, at_end = 0;
};
Speed speed_between(double width, double angle, double off) {
  LiquidSetup setup;
  setup.liquid.spacing = a;
  setup.liquid.sound_speed = 10;
  setup.walls = {sheet(0, 0), sheet(width, angle)};
  setup.slip = {true, true};
  setup.domain = {{-1, -1, -1}, {1, 1, 1}};
  const auto engine = make_liquid_engine(setup, true);
  LiquidState start;
  start.position = {{1e-3 * a, 3e-3 * a, (0.5 + off) * width}};
  start.velocity = {{}};
  start.compression = {0};
  engine->set_state(start, {2, particles::BodyPose{{}, Mat3d::identity(), {}, {}}});
  double fastest = 0;
  for (int k = 0; k < 2000; ++k) {
    const StepFigures f = engine->figures();
    engine->step(0.95 * step_limits(setup.liquid, f.largest_speed, f.largest_acceleration).smallest,
                 engine->poses());
    fastest = std::max(fastest, engine->figures().largest_speed / setup.liquid.sound_speed);
    if (norm(engine->state().position[0]) > 4 * a) break;
  }
  const Vec3d x = engine->state().position[0];
  EXPECT_GT(x.z, 0);
  EXPECT_LT(x.z, width + x.x * std::tan(angle));
  EXPECT_EQ(engine->figures().passed_walls, 0u);
  return {fastest, engine->figures().largest_speed / setup.liquid.sound_speed};
}

TEST(Slit, KeepsAParticleAtRest) {
  for (const double width : {0.05, 0.12, 0.27, 0.4}) {
    const double speed = speed_between(width * a, 0, 0.1).at_end;
    std::printf("a slit of %g spacings: the particle ends with %.2g of the speed of sound\n", width, speed);
    EXPECT_LT(speed, 1e-3);
  }
}

// The walls of a wedge push it out, and no faster than one wall would that it meets.
TEST(Slit, PushesAParticleOutOfAWedge) {
  for (const double angle : {0.1, 0.3, 0.6}) EXPECT_LT(speed_between(0.2 * a, angle, 0.1).largest, 0.25);
}

// The rest of a flat wall, and the other side of an edge, are no second wall.
TEST(Slit, ASecondWallIsOnAnotherSide) {
  const Vec3d up{0, 0, 1};
  EXPECT_EQ(WallRepulsion::share(up, up, up), 0);
  EXPECT_EQ(WallRepulsion::share(up, -up, up), 1);
  EXPECT_NEAR(WallRepulsion::share(up, {1, 0, 0}, {1, 0, 0}), 1, 1e-12) << "a corner";
  for (double angle = 0; angle < 1.5; angle += 0.01)
    EXPECT_LT(WallRepulsion::share(up, {std::sin(angle), 0, std::cos(angle)}, up), 0.03)
        << "beside the edge of two triangles in one plane";
}

}  // namespace slit_test
}  // namespace tandem::test
