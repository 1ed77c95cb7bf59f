// Walls of shape `sphere` are curved for the contact law: R* = R B / (R + B) on a ball of radius B, and R B /
// (B - R) inside it, with m* = m. Reference: Hertz's impact without damping, with
//   deepest overlap (5/4 m v^2 / k)^(2/5), k = 4/3 E* sqrt(R*); duration 2.94328 of that over v.
#include <gtest/gtest.h>

#include <cmath>

#include "dem_server/coupling/tangents.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

struct Impact {
  double depth = 0, duration = 0, rebound = 0;  // [m] [s] [m/s]
};

constexpr double speed = 0.5;  // [m/s]

// Impact on the wall's lowest point, or its highest one; `more`: keys of `dem`.
Impact impact(double ball, bool inside, const nlohmann::json& more = nlohmann::json::object(),
              double share_of_radius = 1) {
  ContactScene scene;
  scene.dem = {{"walls",
                {{{"name", "ball"},
                  {"material", "m"},
                  {"position", {0, 0, inside ? ball : -ball}},
                  {"shape", {{"type", "sphere"}, {"radius", ball}}}}}}};
  if (ball == 0) scene.dem = nlohmann::json::object();
  scene.dem.update(more);
  scene.constants = {{"restitution", 1}, {"friction", 0}};
  if (more.value("contact", "") == "jkr") scene.constants["work_of_adhesion"] = 0;
  ParticleRun run = scene.run(scene.radius, {0, 0, -speed});
  const double dt = 2e-8;
  Impact found;
  for (int w = 0; w < 400 && run.state().position[0].z <= scene.radius; ++w) {
    const dem::WindowOutcome& outcome = run.advance(100, dt);
    for (const Wrench& load : outcome.load)
      if (load.force.z != 0) found.duration += dt;
    found.depth = std::max(
        found.depth, share_of_radius * scene.radius * static_cast<double>(outcome.window.max_overlap_ratio));
  }
  found.rebound = run.state().velocity[0].z;
  return found;
}

void expect_hertz(const Impact& found, double r_eff) {
  const ContactScene scene;
  const double k = 4.0 / 3 * scene.e_star() * std::sqrt(r_eff);
  const double depth = std::pow(1.25 * scene.mass() * speed * speed / k, 0.4);
  expect_close("deepest overlap [m]", found.depth, depth, 1e-3);
  expect_close("duration [s]", found.duration, 2.94328 * depth / speed, 1e-3);
  expect_close("speed after [m/s]", found.rebound, speed, 1e-4);
}

TEST(BallWall, OfTheSameRadiusIsHertzWithHalfTheRadius) {
  const double R = ContactScene{}.radius;
  expect_hertz(impact(R, false), R / 2);
  expect_hertz(impact(R, false, {{"variant", "generic"}}), R / 2);
  expect_hertz(impact(R, false, {{"contact", "jkr"}}), R / 2);
}

TEST(BallWall, SmallerThanTheSphereRelatesTheOverlapToItsOwnRadius) {
  const double R = ContactScene{}.radius;
  expect_hertz(impact(R / 4, false, nlohmann::json::object(), 0.25), R / 5);
}

TEST(BallWall, HollowIsHertzWithTheDifferenceOfCurvatures) {
  const double R = ContactScene{}.radius;
  expect_hertz(impact(5 * R, true), 1.25 * R);
  expect_hertz(impact(5 * R, true, {{"contact", "jkr"}}), 1.25 * R);
  // A closely fitting ball counts as one of 4/3 R.
  expect_hertz(impact(1.05 * R, true), 4 * R);
}

TEST(BallWall, OfGreatRadiusIsThePlane) {
  const double R = ContactScene{}.radius;
  const Impact plane = impact(0, false), outside = impact(1e5 * R, false), inside = impact(1e5 * R, true);
  expect_hertz(plane, R);
  // R* differs by 1e-5 of itself, and the depth by a fifth of that.
  expect_close("depth outside [m]", outside.depth, plane.depth, 5e-6);
  expect_close("depth inside [m]", inside.depth, plane.depth, 5e-6);
  expect_close("duration outside [s]", outside.duration, plane.duration, 2e-3);
}

// Stiffness that the multibody solver receives for a contact with a ball of a body: 3/2 k sqrt(overlap).
TEST(BallWall, StiffnessForTheBodyIsThatOfTheLaw) {
  ContactScene scene;
  const double R = scene.radius, overlap = 1e-3 * R;
  scene.constants = {{"restitution", 1}, {"friction", 0}};
  scene.dem = {{"walls",
                {{{"name", "ball"},
                  {"body", "anvil"},
                  {"material", "m"},
                  {"shape", {{"type", "sphere"}, {"radius", R}}}}}}};
  nlohmann::json json = nlohmann::json::parse(scene.json());
  json["mbd"] = {
      {"bodies", {{{"name", "anvil"}, {"mass", 1}, {"inertia", {1, 1, 1}}, {"position", {0, 0, -R}}}}}};
  ParticleRun run(json.dump(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    s.position[0] = {0, 0, R - overlap};
  });
  run.advance(1, 1e-12);
  const std::vector<particles::BodyPose> poses{{{}, Mat3d::identity(), {}, {}},
                                               {{0, 0, -R}, Mat3d::identity(), {}, {}}};
  const auto bodies = dem::body_tangents(run.engine->wall_tangents(poses), run.surface.boundary_bodies);
  ASSERT_EQ(bodies.size(), 1u);
  expect_close("k_n [N/m]", bodies[0].stiffness[6 * 2 + 2], 2 * scene.e_star() * std::sqrt(R / 2 * overlap),
               1e-6);
}

}  // namespace
}  // namespace tandem::test
