// Unbounded walls on rotating bodies: their speed of approach depends on the distance of a sphere from the
// body's origin, which may be far outside the domain.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/support/solver_run.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;

// A sphere of 1 cm at rest at the origin, which a plane hits from below at 1 m/s. The plane rotates about a
// hinge at the body's origin, `arm` [m] to the left.
struct Hinged : SolverRun {
  double arm;

  Hinged(double length, const json& dem)
      : SolverRun(scene(length, dem), "hinged.json", 1, "cpu"), arm(length) {}
  static json scene(double arm, const json& dem) {
    json all = {{"particles",
                 {{{"name", "p"},
                   {"material", "m"},
                   {"radius", 0.01},
                   {"fill",
                    {{"type", "lattice"},
                     {"min", {-0.01, -0.01, -0.01}},
                     {"max", {0.012, 0.012, 0.012}},
                     {"spacing", 0.02},
                     {"jitter", 0}}}}}},
                {"walls",
                 {{{"name", "flap"},
                   {"body", "tool"},
                   {"material", "m"},
                   {"shape", {{"type", "plane"}, {"point", {arm, 0, -0.02}}, {"normal", {0, 0, 1}}}}}}},
                {"micro_step", 1e-5},
                {"domain", {{"min", {-0.2, -0.2, -0.2}}, {"max", {0.2, 0.2, 0.2}}}}};
    all.update(dem);
    json s = tool_scene(all);
    s["gravity"] = {0, 0, 0};
    s["mbd"]["bodies"][0]["position"] = {-arm, 0, 0};
    return s;
  }
  double hit() {
    for (int w = 0; w < 40; ++w) {
      const auto pose = [&](Nanoseconds t) {
        return Pose{Vec3d{-arm, 0, 0}, exp({0, -to_seconds(t) / arm, 0})};
      };
      protocol::BodyMotion tool;
      tool.begin_pose = pose(now), tool.end_pose = pose(now + window);
      tool.begin_twist = tool.end_twist = {{}, {0, -1 / arm, 0}};
      advance_window({tool});
    }
    return static_cast<double>(solver->observe().velocity[2]);
  }
};

TEST(EndlessWall, OnABodyThatTurnsFarAwayHitsInTime) {
  for (const json& dem : {json::object(), json{{"skin", 0.001}}, json{{"precision", "double"}}})
    for (const double arm : {0.2, 1.0, 2.0, 20.0, 500.0}) {
      Hinged run(arm, dem);
      ASSERT_EQ(run.configured["spheres"], 1);
      const double speed = run.hit();
      std::printf("  hinge %5.1f m away: expected 1.5 m/s, measured %.4f m/s, tolerance 0.01\n", arm, speed);
      EXPECT_NEAR(speed, 1.5, 0.01) << arm << ' ' << dem;
    }
}

}  // namespace
}  // namespace tandem::test
