// Rolling friction of bodies that touch, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mbd_server/contact/contact_force.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

constexpr double R = 0.1, mu_r = 0.05;

// A ball that rolls along x with that speed, on a plane with that slope.
ContactScene rolling_ball(double speed, double slope = 0) {
  ContactScene s({g * std::sin(slope), 0, -g * std::cos(slope)});
  s.add_floor();
  const BodyId ball = s.add_ball("ball", 1, R, {0, 0, R});
  s.body(ball).twist = {{speed, 0, 0}, {0, speed / R, 0}};
  s.material() = {"stuff", 1e6, 0, 0, 0.5, 0.5, mu_r};
  return s;
}

TEST(RollingFriction, BallRollsOut) {
  for (const double step : {1e-2, 1e-3}) {
    const double v = 1, deceleration = 5. / 7 * mu_r * g, time = v / deceleration;
    ContactScene s = rolling_ball(v);
    ContactRun run(s.scene, step);
    run.advance(static_cast<int>(1 / step));
    expect_near("speed after 1 s, steps of " + std::to_string(step), run.velocity().x, v - deceleration,
                1e-3);
    run.advance(static_cast<int>((time + 1) / step));
    const double distance = v * v / (2 * deceleration);
    expect_near("distance", run.position().x, distance, 1e-3 * distance);
    const Vec3d rest = run.position();
    run.advance(static_cast<int>(10 / step));
    expect_near("displacement in the next 10 s", norm(run.position() - rest), 0, 1e-9);
    expect_energy(run, 1e-9);
    const nlohmann::json facts = run.facts();
    expect_near("dissipated", facts.at("mbd_contact_dissipated_J").get<double>(), 0.5 * 1.4 * v * v,
                5e-3 * 0.7);
    expect_near("balance of energy", facts.at("mbd_energy_balance_J").get<double>(), 0, 2e-3 * 0.7);
  }
}

// Below the limit the ball stays for an hour, above it rolls with 5/7 g (sin a - mu_r cos a).
TEST(RollingFriction, BallOnASlope) {
  for (const double share : {0.99, 1.01, 2.0}) {
    const double slope = share * std::atan(mu_r);
    ContactScene s = rolling_ball(0, slope);
    if (share < 1) {
      ContactRun run(s.scene, 0.5);
      run.advance(300);
      const Vec3d begin = run.position();
      EXPECT_LT(begin.x, 1e-3);
      run.advance(6900);
      expect_near("displacement in an hour", norm(run.position() - begin), 0, 1e-12);
      expect_near("spin after an hour", norm(run.spin()), 0, 1e-12);
      continue;
    }
    ContactRun run(s.scene, 1e-2);
    run.advance(100);
    const double v = run.velocity().x, a = 5. / 7 * g * (std::sin(slope) - mu_r * std::cos(slope));
    run.advance(100);
    expect_near("acceleration from 1 s to 2 s", run.velocity().x - v, a, 0.01 * a);
    expect_near("spin", run.spin().y * R, run.velocity().x, 2e-3 * run.velocity().x);
  }
}

// The moment is across the normal, and against the rolling whatever the ball spins about the normal.
TEST(RollingFriction, SpinAboutTheNormalStays) {
  ContactScene s = rolling_ball(1);
  s.body({0}).twist.w_WB.z = 30;
  ContactRun run(s.scene, 1e-3);
  run.advance(1000);
  expect_near("speed along x", run.velocity().x, 1 - 5. / 7 * mu_r * g, 2e-3);
  expect_near("speed along y", run.velocity().y, 0, 1e-4);
  expect_near("spin about the normal", run.spin().z, 30, 1e-3);
}

TEST(RollingFriction, Radius) {
  ContactFeature f;
  f.radius_a = 0.1, f.radius_b = 0.3;
  expect_near("two balls", rolling_radius(f), 0.075, 1e-15);
  f.radius_b = 0;
  expect_near("a ball on a face", rolling_radius(f), 0.1, 0);
  f.radius_a = 0;
  expect_near("a corner on a face", rolling_radius(f), 0, 0);
}

// A tumbling pair of balls and a capsule in other frames.
TEST(RollingFriction, MovesTheSameInEveryFrame) {
  ContactScene s;
  s.add_floor();
  s.add_ball("one", 0.5, 0.1, {0, 0, 0.12});
  s.add_ball("two", 1, 0.2, {0.31, 0.05, 0.21});
  s.add("rod", 0.7, {0.01, 0.01, 0.001}, {4, 0, 0.3}, scene::CapsuleShape{0.05, 0.4, {}});
  s.body({0}).twist = {{2, 0.2, 0}, {0, 9, 3}};
  s.body({1}).twist = {{-1, 0, 0}, {1, 0, 9}};
  s.body({2}).twist = {{0, 0.5, 0}, {1, 2, 3}};
  s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.3, 0.1};
  const auto end = [&](const scene::Scene& scene) {
    ContactRun run(scene, 1e-3);
    run.advance(500);
    expect_energy(run, 1e-9);
    return std::vector<Vec3d>{run.position(0), run.position(1), run.position(2)};
  };
  const std::vector<Vec3d> here = end(s.scene);
  std::mt19937_64 random(3);
  double worst = 0;
  for (int i = 0; i < 4; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {0, 0, 0}, {3. * i, -2, 1});
    const std::vector<Vec3d> there = end(test::moved(s.scene, motion));
    for (std::size_t b = 0; b < 3; ++b) worst = std::max(worst, norm(motion.point_back(there[b]) - here[b]));
  }
  expect_near("largest deviation in four frames [m]", worst, 0, 1e-6);
}

// Energy never rises from window to window, up to what bodies at rest exchange with the springs.
TEST(RollingFriction, EnergyNeverGrows) {
  ContactScene s = rolling_ball(2);
  s.add("rod", 0.7, {0.01, 0.01, 0.001}, {0, 2, 0.3}, scene::CapsuleShape{0.05, 0.4, {}});
  s.body({1}).twist = {{0, 0.5, 0}, {1, 2, 3}};
  ContactRun run(s.scene, 1e-2);
  double last = run.start_energy, rise = 0;
  for (int i = 0; i < 800; ++i) {
    run.advance(1);
    const double now = run.solver.observe().energy;
    rise = std::max(rise, now - last);
    last = now;
  }
  expect_near("largest rise in a window over the energy", rise / run.start_energy, 0, 1e-6);
  expect_near("speed of the ball", norm(run.velocity(0)), 0, 1e-6);
  expect_near("spin of the rod across the normal", std::hypot(run.spin(1).x, run.spin(1).y), 0, 1e-6);
}

// The analytic derivatives against central differences, for a contact that holds and one that rolls.
TEST(RollingFriction, Derivatives) {
  for (const bool rolls : {false, true}) {
    ContactScene s;
    s.add_ball("one", 0.5, 0.1, {0, 0, 0});
    s.add_ball("two", 1, 0.2, {0.2, 0.1, 0.195});
    s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.8, 0.3};
    const Model model = build_model(s.scene);
    const auto link_of_shape = [&](int shape) {
      return static_cast<std::size_t>(model.contact.shape(shape).link);
    };
    const std::size_t one = link_of_shape(0), two = link_of_shape(1);
    std::vector<LinkMotion> links(model.links.size());
    const auto place = [&](std::size_t i, Vec3d p, Quat q, Vector6d V) {
      links[i].p_WL = to_eigen(p), links[i].q_WL = to_eigen(q),
      links[i].R_WL = links[i].q_WL.toRotationMatrix();
      links[i].V = V;
    };
    std::mt19937_64 random(8);
    place(one, {0.01, 0, 0}, test::random_rotation(random), Vector6d{{1, 2, -1, 0.3, 0.1, 0.2}});
    place(two, {0.2, 0.1, 0.19}, test::random_rotation(random), Vector6d{{0.5, 2, 1, 0.2, 0, -0.3}});
    ContactFeature feature;
    feature.a = 0, feature.b = 1;
    feature.radius_a = 0.1, feature.radius_b = 0.2;
    ContactPoint point;
    point.feature = feature;
    const Touch t = touch(model, feature, links);
    ASSERT_LT(t.gap, 0);
    point.mass = point.pressing_mass = 0.3, point.entry_rate = 0.4;
    point.friction.stiffness = 3e4, point.friction.damping = 20;
    point.friction.on_a = in_link(links[one], t.p);
    point.friction.on_b = in_link(links[two], t.p + Vector3d(1e-4, 2e-4, -1e-4));
    point.rolling.radius = rolling_radius(feature);
    point.rolling.stiffness = rolls ? 5000 : 200, point.rolling.damping = 0.02;
    point.rolling.on_a = links[one].R_WL.transpose() * (t.n + Vector3d(0.01, 0, 0.02)).normalized();
    point.rolling.on_b = links[two].R_WL.transpose() * (t.n + Vector3d(0, 0.012, 0)).normalized();
    const ContactForce f = evaluate(model, point, links);
    EXPECT_EQ(f.rolls, rolls);
    const auto wrench = [&](const std::vector<LinkMotion>& at) {
      const ContactForce seen = evaluate(model, point, at, Derivatives::without);
      return wrench_at(seen.p, seen.force, seen.torque);
    };
    // A displacement X of a link carries its velocity with it.
    const auto displaced = [&](std::size_t i, Vector6d X) {
      std::vector<LinkMotion> at = links;
      const Vector3d turn = X.head<3>();
      const Quaterniond q(
          Eigen::AngleAxisd(turn.norm(), turn.norm() > 0 ? Vector3d(turn.normalized()) : Vector3d::UnitX()));
      at[i].q_WL = q * links[i].q_WL, at[i].R_WL = at[i].q_WL.toRotationMatrix();
      at[i].p_WL = q * links[i].p_WL + X.tail<3>();
      at[i].V += cross_motion(X, links[i].V);
      return at;
    };
    const double h = 1e-7;
    double worst_a = 0, worst_b = 0, worst_v = 0;
    for (int k = 0; k < 6; ++k) {
      const Vector6d X = h * Vector6d::Unit(k);
      const auto slope = [&](std::size_t i) {
        return Vector6d((wrench(displaced(i, X)) - wrench(displaced(i, Vector6d(-X)))) / (2 * h));
      };
      worst_a = std::max(worst_a, (slope(one) - f.by_a.col(k)).norm() / f.by_a.norm());
      worst_b = std::max(worst_b, (slope(two) - f.by_b.col(k)).norm() / f.by_b.norm());
      std::vector<LinkMotion> plus = links, minus = links;
      plus[two].V += X, minus[two].V -= X;
      worst_v = std::max(worst_v, ((wrench(plus) - wrench(minus)) / (2 * h) - f.by_velocity.col(k)).norm() /
                                      f.by_velocity.norm());
    }
    expect_near(std::string("by displacements of a, ") + (rolls ? "rolling" : "held"), worst_a, 0, 1e-6);
    expect_near("by displacements of b", worst_b, 0, 1e-6);
    expect_near("by velocities", worst_v, 0, 1e-6);
  }
}

}  // namespace
}  // namespace tandem::mbd
