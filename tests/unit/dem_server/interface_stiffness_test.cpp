// Stiffness and damping of the contacts with walls, compared with closed forms of one contact, and with the
// change of the engine's loads when a body is displaced.
#include "dem_server/engine/interface_stiffness.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "dem_server/coupling/tangents.hpp"
#include "dem_server/laws/generic.hpp"
#include "tests/support/particle_run.hpp"

namespace tandem::test {
namespace {

using dem::ContactTangent;

// k_n delta^(3/2), c_n delta^(1/4), and Mindlin's spring in proportion to sqrt(delta).
constexpr double overlap = 3e-5;
const dem::Coefficients<double> coefficients{2e6, 40, 1.5e6, 30, 0.4};

dem::Contact<double> contact(Vec3d slip = {}) {
  dem::Contact<double> c;
  c.n = {0, 0, 1};
  c.overlap = overlap;
  c.slip = slip;
  c.dt = 1e-5;
  return c;
}

void expect_near(const char* what, double measured, double expected) {
  std::printf("  %-18s expected %.9g  measured %.9g  tolerance 1e-6\n", what, expected, measured);
  EXPECT_NEAR(measured, expected, 1e-6 * std::abs(expected));
}

TEST(InterfaceStiffness, OfHertzAndMindlin) {
  ContactTangent t;
  dem::differentiate<dem::HertzMindlin>(contact(), coefficients, 0, {1e-7, 0, 0}, t);
  expect_near("k_n", t.k_n, 1.5 * coefficients.k_n * std::sqrt(overlap));
  expect_near("d_n", t.d_n, coefficients.c_n * std::pow(overlap, 0.25));
  expect_near("k_t", t.k_t, coefficients.k_t * std::sqrt(overlap));
  expect_near("d_t", t.d_t, coefficients.c_t * std::pow(overlap, 0.25));
}

TEST(InterfaceStiffness, OfTheLawOfThePaper) {
  ContactTangent t;
  const double s = 2e-6;
  dem::differentiate<dem::Paper>(contact(), coefficients, 0, {0, s, 0}, t);
  expect_near("k_n", t.k_n, 1.5 * coefficients.k_n * std::sqrt(overlap));
  expect_near("k_t", t.k_t, 1.5 * coefficients.k_t * std::sqrt(s));
  expect_near("d_t", t.d_t, coefficients.c_t * std::pow(s, 0.25));
}

TEST(InterfaceStiffness, OfAContactThatHardlyTouches) {
  dem::Contact<double> c = contact();
  c.overlap = 1e-13;
  c.r_eff = 0.01;
  ContactTangent t;
  const auto mindlin = static_cast<std::uint32_t>(scene::ContactLaw::hertz_mindlin);
  dem::differentiate<dem::GenericLaw>(c, coefficients, mindlin, {}, t);
  expect_near("k_n", t.k_n, 1.5 * coefficients.k_n * std::sqrt(c.overlap));
  expect_near("k_t", t.k_t, coefficients.k_t * std::sqrt(c.overlap));
  for (const scene::ContactLaw law : {scene::ContactLaw::jkr, scene::ContactLaw::sjkr}) {
    c.adhesion = 0.1;
    dem::differentiate<dem::GenericLaw>(c, coefficients, static_cast<std::uint32_t>(law), {}, t);
    EXPECT_TRUE(std::isfinite(t.k_n) && std::isfinite(t.k_t) && std::isfinite(t.d_n) && std::isfinite(t.d_t));
  }
}

TEST(InterfaceStiffness, AFreshContactSticksAndASlidingOneHasNoneAlong) {
  ContactTangent fresh, sliding, smooth;
  dem::differentiate<dem::HertzMindlin>(contact(), coefficients, 0, {}, fresh);
  expect_near("k_t, no spring yet", fresh.k_t, coefficients.k_t * std::sqrt(overlap));
  dem::differentiate<dem::HertzMindlin>(contact({2, 0, 0}), coefficients, 0, {1e-5, 0, 0}, sliding);
  EXPECT_LT(sliding.k_t, 1e-6 * fresh.k_t);
  EXPECT_LT(sliding.d_t, 1e-6 * fresh.d_t);
  dem::differentiate<dem::HertzFrictionless>(contact({2, 0, 0}), coefficients, 0, {}, smooth);
  EXPECT_EQ(smooth.k_t, 0);
  EXPECT_EQ(smooth.k_n, fresh.k_n);
}

TEST(InterfaceStiffness, OneContactAtAnArmIsASpringThere) {
  ContactTangent contact;
  contact.arm = {0.3, -0.2, 0.1};
  contact.normal = normalized(Vec3d{1, 2, -2});
  contact.k_n = 5e4, contact.k_t = 2e4, contact.d_n = 70;
  dem::WallTangent tangent;
  dem::add(contact, tangent);
  const auto bodies = dem::body_tangents({{}, tangent}, {ground, BodyId{4}});
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0].body, 4u);
  const Vec3d move{1e-3, -2e-3, 3e-3}, rolling{0.01, 0.02, -0.03};
  const Vec3d at = move + cross(rolling, contact.arm);
  const Vec3d along = dot(at, contact.normal) * contact.normal;
  const Vec3d force = contact.k_n * along + contact.k_t * (at - along), torque = cross(contact.arm, force);
  const double x[6] = {move.x, move.y, move.z, rolling.x, rolling.y, rolling.z};
  for (std::size_t row = 0; row < 6; ++row) {
    double sum = 0;
    for (std::size_t column = 0; column < 6; ++column) {
      sum += bodies[0].stiffness[6 * row + column] * x[column];
      EXPECT_NEAR(bodies[0].stiffness[6 * row + column], bodies[0].stiffness[6 * column + row], 1e-9);
    }
    const int axis = static_cast<int>(row % 3);
    EXPECT_NEAR(sum, row < 3 ? force[axis] : torque[axis], 1e-9 * norm(force));
  }
  EXPECT_TRUE(dem::body_tangents({tangent, {}}, {ground, BodyId{4}}).empty());
}

// Whole numbers, whose sums are exact in any order.
TEST(InterfaceStiffness, SumsEachPairOnceUnderItsBody) {
  for (const std::uint32_t count : {1u, 100u, 1000u}) {
    constexpr std::uint32_t bodies = 3;
    std::vector<dem::NearBody> near(count);
    std::vector<dem::WallTangent> tangent(count), runs(dem::tangent_runs * bodies), sum(bodies),
        expected(bodies);
    for (std::uint32_t i = 0; i < count; ++i) {
      near[i].body = i % 7 % bodies;
      for (int k = 0; k < dem::WallTangent::entries; ++k) {
        tangent[i].entry[k] = 100 * i + k;
        expected[near[i].body].entry[k] += tangent[i].entry[k];
      }
    }
    particles::WindowProgress window;
    window.near = count;
    const dem::SumTangentRuns add_up{&window, near.data(), bodies, tangent.data(), runs.data()};
    for (std::uint32_t i = 0; i < dem::tangent_runs * dem::WallTangent::entries; ++i) add_up(i);
    const dem::SumTangents add_runs{bodies, runs.data(), sum.data()};
    for (std::uint32_t i = 0; i < bodies * dem::WallTangent::entries; ++i) add_runs(i);
    for (std::uint32_t body = 0; body < bodies; ++body)
      EXPECT_THAT(sum[body].entry, testing::ElementsAreArray(expected[body].entry)) << count;
  }
}

// 200 spheres in an inclined box, without friction, so that the loads depend on overlaps alone.
const std::string box_of_spheres =
    R"({"tandem": "1.0", "name": "box", "end_time": 1.0,
  "mbd": {"bodies": [{"name": "box", "mass": 5, "inertia": [0.1, 0.1, 0.1], "position": [0, 0, 0.1],
                      "orientation": [0.9807852804032304, 0.11705419320967695, 0.1560722576129026, 0]}]},
  "dem": {"contact": "hertz_frictionless", "precision": "double",
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
    "pairs": [{"a": "glass", "b": "glass", "restitution": 0.1, "friction": 0}],
    "particles": [{"name": "fill", "material": "glass", "radius": 0.01,
      "fill": {"type": "lattice", "min": [-0.06, -0.06, 0.05], "max": [0.06, 0.06, 0.25], "spacing": 0.021, "jitter": 0.5,
               "count": 150}}],
    "walls": [{"name": "case", "body": "box", "material": "glass", "shape": {"type": "box", "size": [0.2, 0.2, 0.3]}}],
    "domain": {"min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5]}}})";

// Requested after each window, they are computed together with it.
TEST(InterfaceStiffness, BelongsToTheStateAndThePosesItIsAskedFor) {
  ParticleRun run(box_of_spheres);
  constexpr double dt = 2e-5;
  const Pose pose = run.scene.mbd->bodies[0].pose;
  const std::vector<particles::BodyPose> poses{{{}, Mat3d::identity(), {}, {}},
                                               {pose.p_WB, pose.q_WB.matrix(), {}, {}}};
  std::vector<particles::BodyPose> elsewhere = poses;
  elsewhere[1].p.x += 1e-4;
  const auto stiffness = [&run](const std::vector<particles::BodyPose>& at) {
    const auto bodies = dem::body_tangents(run.engine->wall_tangents(at), run.surface.boundary_bodies);
    return bodies.size() == 1 ? bodies[0].stiffness : std::array<double, 36>{};
  };
  auto first = stiffness(poses);
  for (int i = 0; i < 50; ++i) {  // lists outgrow their memory
    run.advance(400, dt);
    first = stiffness(poses);
  }
  run.advance(400, dt);
  const auto second = stiffness(poses);
  EXPECT_NE(second, first);
  EXPECT_NE(stiffness(elsewhere), second);
  EXPECT_EQ(stiffness(poses), second);
  run.engine->save();
  run.advance(400, dt);
  EXPECT_NE(stiffness(poses), second);
  run.engine->restore();
  EXPECT_EQ(stiffness(poses), second);
  EXPECT_EQ(run.engine->remove({.min = {-1, -1, -1}, .max = {1, 1, 1}, .normal = {}}), 150u);
  EXPECT_EQ(stiffness(poses), (std::array<double, 36>{}));
}

TEST(InterfaceStiffness, IsTheDerivativeOfTheLoad) {
  ParticleRun run(box_of_spheres);
  constexpr double dt = 2e-5;
  for (int i = 0; i < 50; ++i) run.advance(400, dt);
  const Pose pose = run.scene.mbd->bodies[0].pose;
  const particles::BodyPose ground_pose{{}, Mat3d::identity(), {}, {}},
      box_pose{pose.p_WB, pose.q_WB.matrix(), {}, {}};
  const std::vector poses{ground_pose, box_pose};
  const auto bodies = dem::body_tangents(run.engine->wall_tangents(poses), run.surface.boundary_bodies);
  ASSERT_EQ(bodies.size(), 1u);
  const auto again = dem::body_tangents(run.engine->wall_tangents(poses), run.surface.boundary_bodies);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].stiffness, bodies[0].stiffness);
  EXPECT_EQ(again[0].damping, bodies[0].damping);

  // The load at the begin of a window in which the body starts elsewhere.
  run.engine->save();
  const auto load_at = [&](Vec3d move, Vec3d rolling) {
    run.engine->restore();
    const Pose moved{pose.p_WB + move, (exp(rolling) * pose.q_WB).normalized()};
    const std::vector<particles::PreparedPath> paths{particles::prepare_path({}, dt),
                                                     particles::prepare_path({moved, moved, {}, {}}, dt)};
    const Wrench w = run.engine->advance({1, dt, paths, 0, 1e-3}).load.at(1);
    return std::array{w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z};
  };
  const double step = 1e-8;  // [m], and [rad] at an arm of a tenth of a metre
  double largest = 0, worst = 0, rotational = 0;
  for (int column = 0; column < 6; ++column) {
    Vec3d move, rolling;
    (column < 3 ? move : rolling)[column % 3] = column < 3 ? step : 10 * step;
    const auto plus = load_at(move, rolling), minus = load_at(-move, -rolling);
    for (std::size_t row = 0; row < 6; ++row) {
      const double scale = (row < 3 ? 1 : 10) * (column < 3 ? 1 : 10);  // to N/m at that arm
      const double measured = -(plus[row] - minus[row]) / (2 * (column < 3 ? step : 10 * step)) * scale;
      const double reported = bodies[0].stiffness[6 * row + static_cast<std::size_t>(column)] * scale;
      largest = std::max(largest, std::abs(measured));
      (column < 3 ? worst : rotational) =
          std::max(column < 3 ? worst : rotational, std::abs(measured - reported));
    }
  }
  std::printf(
      "  largest %.4g N/m; difference %.2e (moves), %.2e (turns, which "
      "the turning of the loads adds to)\n",
      largest, worst / largest, rotational / largest);
  // Moving grains add the change of their damping forces with the overlap.
  EXPECT_LT(worst, 0.01 * largest);
  EXPECT_LT(rotational, 0.05 * largest);
}

}  // namespace
}  // namespace tandem::test
