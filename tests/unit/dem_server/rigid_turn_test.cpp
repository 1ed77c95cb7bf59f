// Contacts that rotate as a whole, both partners as one rigid body: in their frame nothing changes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/math/rotation.hpp"
#include "dem_server/laws/cohesive.hpp"
#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/hooke.hpp"
#include "dem_server/laws/paper.hpp"
#include "dem_server/laws/rolling.hpp"
#include "tests/support/solver_run.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;

// A contact with a spring that is rotated once about an axis oblique to its normal. Returns the deviation of
// its tangential force, and of its rolling moment, from the rotated initial values, relative to their size.
struct Off {
  double force = 0, moment = 0;
};
template <class Law, class Real>
Off after_a_turn(int steps) {
  const double dt = 1e-5, step = 2 * std::numbers::pi / steps;
  const Vec3d axis = normalized(Vec3d{1, -2, 2});
  const auto at = [&](double rotate_spring) { return exp(rotate_spring * axis); };
  const Vec3d n = normalized(Vec3d{0.2, 0.3, 1}), across = normalized(cross(n, Vec3d{1, 0, 0}));
  dem::Coefficients<Real> k;
  k.k_n = k.k_t = 1e6, k.friction = 1;
  const dem::RollingConstants<Real> rolling{Real(0.1), Real(0)};
  dem::Contact<Real> c;
  c.overlap = Real(1e-5), c.dt = static_cast<Real>(dt);
  c.r_eff = Real(1e-2), c.m_eff = Real(1e-3), c.adhesion = Real(0.1);
  Vec3<Real> spring = (1e-7 * across).template as<Real>(), rolled = (1e-5 * across).template as<Real>();
  Vec3d force, moment, first_force, first_moment;
  for (int s = 0; s <= steps; ++s) {
    const Vec3d now = at(s * step).rotate(n), middle = at((s - 0.5) * step).rotate(n);
    c.n = now.as<Real>();
    // Leapfrog stores the angular velocities of half a step before.
    c.normal_rotation = s == 0 ? Real(0) : static_cast<Real>(step * dot(axis, middle));
    const auto f = Law{}(c, k, 0, spring);
    force = f.tangential.template as<double>();
    moment = dem::RollingResistance{}(c, f, {}, rolling, Real(1e-9), rolled).template as<double>();
    if (s == 0) first_force = force, first_moment = moment;
  }
  return {norm(force - first_force) / norm(first_force), norm(moment - first_moment) / norm(first_moment)};
}

template <class Law>
void expect_no_change(const char* law) {
  const Off coarse = after_a_turn<Law, double>(1000), fine = after_a_turn<Law, double>(100000),
            mixed = after_a_turn<Law, float>(100000);
  std::printf(
      "  %-14s after a turn in 1000, 100000 steps: force %.1e, %.1e, moment %.1e, %.1e; single %.1e\n", law,
      coarse.force, fine.force, coarse.moment, fine.moment, mixed.force);
  // First order in the step: the projection onto a plane that rotates by a small angle prefers one direction
  // by half the square of the angle.
  EXPECT_LT(coarse.force, 5e-3) << law;
  EXPECT_LT(fine.force, 5e-5) << law;
  EXPECT_LT(fine.moment, 5e-5) << law;
  EXPECT_LT(mixed.force, 5e-3) << law;  // 100000 roundings
}

TEST(RigidTurn, SpringsGoWithTheContact) {
  expect_no_change<dem::HertzMindlin>("hertz_mindlin");
  expect_no_change<dem::Hooke>("hooke");
  expect_no_change<dem::Paper>("paper");
  expect_no_change<dem::Jkr>("jkr");
}

// A sphere that friction and rolling resistance hold on a turntable, 20 rad/s at 2 cm.
struct Turntable : SolverRun {
  static constexpr double rate = 20, at = 0.02, radius = 0.005;  // [rad/s] [m] [m]

  explicit Turntable(const json& dem) : SolverRun(scene(dem), "turntable.json", 1, "cpu") {}
  static json scene(const json& dem) {
    json all = {{"rolling", "elastic_plastic"},
                {"twisting", "elastic_plastic"},
                {"particles",
                 {{{"name", "p"},
                   {"material", "m"},
                   {"radius", radius},
                   {"velocity", {0, rate * at, 0}},
                   {"fill",
                    {{"type", "lattice"},
                     {"min", {at - radius, -radius, 0}},
                     {"max", {at + radius, radius, 2 * radius}},
                     {"spacing", 2 * radius},
                     {"jitter", 0},
                     {"count", 1}}}}}},
                {"walls",
                 {{{"name", "table"},
                   {"body", "tool"},
                   {"material", "m"},
                   {"shape", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}}}},
                {"micro_step", 2e-5},
                {"domain", {{"min", {-0.1, -0.1, -0.1}}, {"max", {0.1, 0.1, 0.1}}}}};
    all.update(dem);
    json s = tool_scene(all);
    json& material = s["dem"]["materials"][0];
    material["friction"] = 2;
    material["rolling_friction"] = 0.9;
    material["rolling_damping"] = 0.3;
    s["mbd"]["bodies"][0]["position"] = {0, 0, 0};
    return s;
  }
  // Position relative to the turntable [m].
  Vec3d position() {
    const auto& x = solver->observe().position;
    return exp({0, 0, -rate * to_seconds(now)}).rotate({x[0], x[1], x[2]});
  }
  void turn(double seconds) {
    for (int w = 0; w < static_cast<int>(seconds / 1e-3); ++w) {
      const auto pose = [&](Nanoseconds t) { return Pose{Vec3d{}, exp({0, 0, rate * to_seconds(t)})}; };
      protocol::BodyMotion table;
      table.begin_pose = pose(now), table.end_pose = pose(now + window);
      table.begin_twist = table.end_twist = {{}, {0, 0, rate}};
      advance_window({table});
    }
  }
};

TEST(RigidTurn, WhatFrictionHoldsOnATurntableStaysThere) {
  for (const json& dem : {json{{"precision", "double"}}, json::object()}) {
    Turntable run(dem);
    run.turn(1);
    const Vec3d before = run.position();
    run.turn(2);
    const Vec3d crept = run.position() - before;
    std::printf("  crept on the table in 6.4 turns: %.1e m across, %.1e m along, of a radius of 5e-3 m\n",
                crept.x, crept.y);
    EXPECT_LT(norm(crept), 1e-6);
  }
}

}  // namespace
}  // namespace tandem::test
