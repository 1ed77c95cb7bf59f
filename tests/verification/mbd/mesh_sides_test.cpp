// The two sides of a surface: bodies that come from behind are refused, and nothing passes from the front.
#include <cmath>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/mesh_scenes.hpp"

namespace tandem::mbd::contacts {
namespace {

scene::Geometry shape_of(int kind) {
  switch (kind) {
    case 0:
      return scene::SphereShape{0.1};
    case 1:
      return scene::CapsuleShape{0.06, 0.2, {}};
    case 2:
      return scene::BoxShape{{0.2, 0.24, 0.16}, {}};
    case 3:
      return scene::HullShape{
          {{0, 0, -.1}, {.1, .03, .06}, {-.1, .04, .06}, {0, -.1, .08}, {.02, .05, .12}}, {}, 1};
    default:
      scene::CylinderShape c;
      c.radius = 0.1, c.height = 0.1;
      return c;
  }
}
constexpr const char* kinds[] = {"sphere", "capsule", "box", "hull", "cylinder"};

// Bodies below a sheet whose normals point up: at rest under a load, and thrown at it.
TEST(MeshSides, EveryShapeFromBehindIsRefused) {
  std::mt19937_64 random(5);
  for (int kind = 0; kind < 5; ++kind)
    for (const double speed : {0., 1., 5., 60.})
      for (int i = 0; i < 4; ++i) {
        MeshScene s({0, 0, speed > 0 ? 0. : 9.});
        if (i < 2)
          s.add_ground_mesh("sheet", irregular_plane(4, 8));
        else
          s.add_ground("hills", field(4, 4, 40, 40, [](double x, double y) {
                         return 0.02 * std::sin(5 * x) * std::cos(4 * y);
                       }));
        const BodyId body =
            s.add("body", 1, {4e-3, 5e-3, 6e-3}, {0.03, 0.02, -0.3 - 0.07 * i}, shape_of(kind));
        s.body(body).pose.q_WB = kind == 4 ? exp(Vec3d{1.5, 0.1 * i, 0}) : test::random_rotation(random);
        s.body(body).twist.v_WB = {0, 0, speed};
        const std::string said = refusal_of(s, 80, 1e-2);
        EXPECT_NE(said.find("comes to shape"), std::string::npos) << kinds[kind] << speed << said;
        EXPECT_NE(said.find("from behind"), std::string::npos) << kinds[kind] << speed << said;
        EXPECT_NE(said.find(i < 2 ? "\"sheet\"" : "\"hills\""), std::string::npos) << said;
      }
}

// On a floor that winds the wrong way, at its surface and pressed into it.
TEST(MeshSides, WhatStandsOnABackIsRefused) {
  TriangleMesh floor = irregular_plane(4, 8);
  for (auto& t : floor.triangles) std::swap(t[0], t[1]);
  for (const int kind : {0, 2})
    for (const double depth : {0., 1e-4, 0.03}) {
      MeshScene s;
      s.add_ground_mesh("floor", floor);
      s.add("body", 1, {4e-3, 5e-3, 6e-3}, {0.03, 0.02, (kind == 0 ? 0.1 : 0.08) - depth}, shape_of(kind));
      const std::string said = refusal_of(s, 0);
      EXPECT_NE(said.find("from behind"), std::string::npos) << kinds[kind] << depth << said;
    }
}

// Bodies that go over the open edge of a surface and fall past it meet no back.
TEST(MeshSides, WhatFallsOverAnEdgeIsNotBehind) {
  for (const int kind : {0, 1, 2, 3})
    for (const double speed : {0.3, 1.}) {
      MeshScene s;
      s.add_ground("table", field(1, 1, 10, 10, [](double, double) { return 0.; }));
      s.add("body", 1, {4e-3, 5e-3, 6e-3}, {0.41, 0.02, 0.17}, shape_of(kind));
      s.body({0}).twist.v_WB = {speed, 0, 0};
      s.material() = {"stuff", 1e5, 0, 0, 0.2, 0.1};
      ContactRun run = s.run(1e-2);
      for (int i = 0; i < 300 && run.position().z > -1; ++i) run.advance(1);
      std::printf("  %s at %.1f m/s: ends at x %.3f, z %.3f\n", kinds[kind], speed, run.position().x,
                  run.position().z);
      EXPECT_GT(run.position().x, 0.4);
      EXPECT_LT(run.position().z, -1);
      expect_energy(run, 1e-9);
    }
}

// Whatever the phase of its steps, a fast ball bounces: also where a step would end with its centre on a
// face.
TEST(MeshSides, AFastBallBouncesAtEveryPhase) {
  std::mt19937_64 random(3);
  const test::RigidMotion turned(test::random_rotation(random), {0, 0, 0}, {0.3, -2, 1});
  int runs = 0;
  double worst = 0;
  const auto bounce = [&](MeshScene s, double radius, double speed, double distance, Vec3d normal,
                          bool in_other_frame) {
    const Vec3d along =
        std::abs(normal.z) > 0.5 ? Vec3d{0.013, 0.021, 0} : Vec3d{0.021 * normal.y, 0.021 * normal.x, 0.013};
    const BodyId ball = s.add_ball("ball", 0.01, radius, distance * normal + along);
    s.body(ball).twist.v_WB = -speed * normal;
    s.material() = {"stuff", 1e9, 0, 0, 1, 0};
    ContactRun run(in_other_frame ? test::moved(s.scene, turned) : s.scene, 1e-2, s.meshes);
    run.advance(static_cast<int>(std::ceil(distance / speed / 1e-2)) + 1);
    const Vec3d v = in_other_frame ? turned.vector_back(run.velocity()) : run.velocity();
    const double error = std::abs(dot(v, normal) / speed - 1);
    EXPECT_LT(error, 1e-3) << "radius " << radius << ", speed " << speed << ", distance " << distance;
    worst = std::max(worst, error), ++runs;
  };
  for (const bool other : {false, true}) {
    for (const double radius : {0.005, 0.01, 0.02})
      for (const double speed : {10., 100.}) {
        MeshScene flat({0, 0, 0});
        flat.add_ground("field", field(1, 1, 4, 4, [](double, double) { return 0.; }));
        for (int n = 0; n < 12; ++n) bounce(flat, radius, speed, 0.4 + n * 1e-3, {0, 0, 1}, other);
        for (int n = 0; n < 3; ++n) bounce(flat, radius, speed, 0.5 + 0.1 * n + radius, {0, 0, 1}, other);
      }
    for (const Vec3d normal :
         {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}, Vec3d{0, 0, -1}})
      for (const double radius : {0.01, 0.2})
        for (const double distance : {0.75, 0.8, 1., 1.013, 1.5}) {
          MeshScene cube({0, 0, 0});
          cube.add_ground_mesh("cube", box_mesh({1, 1, 1}));
          bounce(cube, radius, 5, distance, normal, other);
          bounce(cube, radius, 50, distance, normal, other);
        }
  }
  std::printf("  %d balls: largest relative error of the speed %.1e (tolerance 1e-3)\n", runs, worst);
}

// A box whose corners are at the surface to the last digit, over the edge of a block.
TEST(MeshSides, ABoxWithoutAGapOverhangsAnEdge) {
  for (const double gap : {0., 1e-13, -1e-13, 1e-9, -1e-9})
    for (const double x : {0.42, 0.45, 0.5}) {
      MeshScene s;
      s.add_ground_mesh("block", box_mesh({1, 1, 1}));
      s.add_box("box", 1, {0.2, 0.2, 0.2}, {x, 0, 0.6 + gap});
      s.material() = {"stuff", 1e6, 0, 0, 0.2, 0.5};
      ContactRun run = s.run(5e-3);
      run.advance(4);
      EXPECT_NEAR(run.position().z, 0.6, 1e-4) << gap << " " << x;
    }
}

}  // namespace
}  // namespace tandem::mbd::contacts
