// Round walls compared with closed forms, with the planes that they approximate, and with ever finer prisms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"
#include "tests/verification/dem/impact.hpp"

namespace tandem::test {
namespace round_walls_test {

constexpr double R = 0.01, g = 9.81;  // radius of the ball [m], [m/s2]
constexpr Ball ball{1e9, 0.3, 2500, 0.7, 0.3, R};

const Variant hertz_mindlin{"hertz_mindlin", "hertz_mindlin", "", true};
const Variant frictionless{"hertz_frictionless", "hertz_frictionless", "", false};
const Variant full{"generic_double", "hertz_mindlin", R"("precision": "double",)", true};

// Gap between ball and wall at the start; without it rounding decides whether the first step has a contact
// [m].
constexpr double start_gap = 1e-8;
const std::string plane_wall =
    nlohmann::json{{"name", "plane"},
                   {"material", "rigid"},
                   {"shape", {{"type", "plane"}, {"point", {0, 0, -start_gap}}, {"normal", {0, 0, 1}}}}}
        .dump();
// A spherical wall; the ball starts over its lowest point if it is inside, else over its highest point.
std::string sphere_wall(double radius, bool inside) {
  return nlohmann::json{{"name", "ball"},
                        {"material", "rigid"},
                        {"position", {0, 0, (inside ? radius : -radius) - start_gap}},
                        {"shape", {{"type", "sphere"}, {"radius", radius}}}}
      .dump();
}
// A cylinder along y, likewise; or a prism of the same inner radius, with the ball over the middle of a face.
std::string trough(double radius, bool inside, nlohmann::json height = nullptr, int faces = 0) {
  nlohmann::json wall{{"name", "trough"},
                      {"material", "rigid"},
                      {"position", {0, 0, (inside ? radius : -radius) - start_gap}},
                      {"orientation", {std::sqrt(0.5), std::sqrt(0.5), 0, 0}},
                      {"shape", {{"type", "cylinder"}, {"radius", radius}}}};
  if (!height.is_null()) wall["shape"]["height"] = height;
  if (faces > 0) {
    wall["shape"]["segments"] = faces;
    wall["shape"]["radius"] = radius / std::cos(std::numbers::pi / faces);
  }
  return wall.dump();
}

// The period of a ball that starts at rest, at a small angle, in a trough of radius `a`.
double period_in_trough(const Variant& variant, const Ball& b, double a, double angle, double depth) {
  nlohmann::json scene = nlohmann::json::parse(impact_scene(variant, b, 1, trough(a, true)));
  scene["gravity"] = {0, 0, -g};
  const double arm = a - R + depth;
  ParticleRun run(scene.dump(), tested_backend(), 1, [&](particles::Spheres& s) {
    s.position = {{arm * std::sin(angle), 0, a - arm * std::cos(angle)}};
    s.velocity = {{0, 0, 0}};
  });
  constexpr double dt = 1e-5;
  double last_x = arm * std::sin(angle), passage = 0;
  for (int k = 1; k < 40000; ++k) {
    constexpr std::uint32_t steps = 10;
    run.advance(steps, dt);
    const double x = run.state().position.at(0).x, time = k * steps * dt;
    if (last_x < 0 && x >= 0) {
      const double at = time - steps * dt * x / (x - last_x);
      if (passage > 0) return at - passage;
      passage = at;
    }
    last_x = x;
  }
  ADD_FAILURE() << "the ball did not come back twice";
  return 0;
}

// A ball that slides is a pendulum of length a - R. A rolling ball has the additional inertia 2/5 m R^2, as
// if its mass were 7/5 of it.
TEST(Trough, HasThePeriodOfAPendulum) {
  constexpr double a = 0.1, angle = 0.02;
  Ball b = ball;
  b.restitution = 0.3;  // damps the oscillation in the normal direction that the start excites
  b.friction = 0.6;
  const double depth = std::pow(b.mass() * g / b.stiffness_on_plane(), 2.0 / 3);
  const double large = 1 + angle * angle / 16;  // factor of a pendulum's period for a finite amplitude
  const double sliding = 2 * std::numbers::pi * std::sqrt((a - R + depth) / g) * large;
  const double turning = 1 + 0.4 * R * R / ((R - depth) * (R - depth));
  expect_row(frictionless, "period of sliding in a trough",
             period_in_trough(frictionless, b, a, angle, depth), sliding, 1e-4);
  for (const Variant& v : {hertz_mindlin, full})
    expect_row(v, "period of rolling in a trough", period_in_trough(v, b, a, angle, depth),
               sliding * std::sqrt(turning), 1e-3);
}

Rebound on(const std::string& wall, Vec3d velocity) {
  return impact_on_walls(impact_scene(full, ball, 1, wall), {}, ball, {}, velocity, {20, -10, 5}, 400);
}
Vec3d oblique(double degrees) {
  const double angle = degrees * std::numbers::pi / 180, heading = 0.4;
  return {std::sin(angle) * std::cos(heading), std::sin(angle) * std::sin(heading), -std::cos(angle)};
}
double difference(const Rebound& a, const Rebound& b) {
  return std::fmax(norm(a.velocity - b.velocity) / norm(b.velocity), norm(a.spin - b.spin) / norm(b.spin));
}

// The law treats a cylinder as flat, so that it differs from a plane only by the rotation of the normal along
// the path of the ball: not at all for a ball that arrives along the normal without spin, and in proportion
// to 1/radius for others. The law accounts for the curvature of a sphere. It changes depth and duration
// (tests/unit/dem_server/ball_walls_test.cpp), but not the restitution, apart from the error of finite steps.
TEST(RoundWall, ReflectsLikeThePlaneThatItComesNearTo) {
  for (const bool inside : {true, false}) {
    const auto straight = [&](const std::string& wall) {
      return impact_on_walls(impact_scene(full, ball, 1, wall), {}, ball, {}, {0, 0, -1}, {}, 400);
    };
    const double plane = straight(plane_wall).velocity.z;
    const char* side = inside ? "inside" : "outside";
    expect_row(full, std::string("rebound from a sphere, ") + side,
               straight(sphere_wall(0.04, inside)).velocity.z, plane, 3e-4);
    expect_row(full, std::string("rebound from a cylinder, ") + side,
               straight(trough(0.04, inside)).velocity.z, plane, 1e-9);
    for (const double degrees : {30.0, 70.0}) {
      const Rebound flat = on(plane_wall, oblique(degrees));
      for (const bool sphere : {true, false}) {
        const auto wall = [&](double a) { return sphere ? sphere_wall(a, inside) : trough(a, inside); };
        const double near = difference(on(wall(1), oblique(degrees)), flat),
                     nearer = difference(on(wall(1000), oblique(degrees)), flat);
        std::printf("  %-8s %-7s %2.0f degrees: differs from the plane by %.2e at 1 m, %.2e at 1000 m\n",
                    sphere ? "sphere" : "cylinder", side, degrees, near, nearer);
        EXPECT_LT(near, 1e-2);
        EXPECT_GT(near, 1e-6);
        EXPECT_LT(nearer, (sphere ? 2.5e-3 : 1.1e-3) * near);
      }
    }
  }
}

TEST(RoundWall, IsTheLimitOfPrisms) {
  constexpr double a = 2.5 * R;
  for (const bool inside : {true, false}) {
    const Vec3d v = 10 * oblique(40);  // fast enough to pass several of the narrow faces
    const Rebound round = on(trough(a, inside, 1), v);
    EXPECT_LT(difference(round, on(trough(a, inside), v)), 1e-9)
        << "far from its ends, a height says nothing";
    double last = 1e300;
    for (const int segments : {62, 250, 998}) {  // one face is across z
      const Rebound prism = on(trough(a, inside, 1, segments), v);
      const double error = difference(prism, round);
      std::printf("  %s a prism of %4d faces: velocity or spin differs by %.2e\n", inside ? "in" : "on",
                  segments, error);
      EXPECT_LT(error, 0.5 * last);
      last = error;
    }
    EXPECT_LT(last, 1e-3);
  }
}

}  // namespace round_walls_test
}  // namespace tandem::test
