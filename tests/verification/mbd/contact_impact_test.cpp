// Impacts of bodies, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

// Height to which a body returns that falls by `fall`, over `fall`.
double rebound(ContactRun& run, double lowest, double fall) {
  double best = 0;
  bool met = false;
  const int windows = static_cast<int>(std::ceil(2.2 * std::sqrt(2 * fall / g) / run.window));
  for (int i = 0; i < windows; ++i) {
    run.advance(1);
    const double v = run.velocity().z;
    met = met || v > 0;
    if (met && v > 0) best = std::max(best, run.position().z - lowest + v * v / (2 * g));
  }
  return best / fall;
}

TEST(Contact, BallReturnsByItsRestitution) {
  for (const bool hertz : {false, true})
    for (const double e : {0.1, 0.5, 0.9, 1.0})
      for (const double step : {1e-2, 1e-3}) {
        ContactScene s;
        s.add_floor();
        s.add_ball("ball", 1, 0.1, {0, 0, 0.6});
        s.material().restitution = e;
        s.material().stiffness = 1e8;
        if (hertz) s.material().stiffness.reset(), s.material().young = 1e11, s.material().poisson = 0.3;
        ContactRun run(s.scene, step);
        const double returned = std::sqrt(rebound(run, 0.1, 0.5));
        expect_near(std::string(hertz ? "Hertz" : "linear") + ", steps of " + std::to_string(step) +
                        " s: rate after over before",
                    returned, e, 0.01 * e);
        expect_energy(run, e < 1 ? 1e-9 : 5e-4);  // of second order in the step
      }
}

TEST(Contact, BoxReturnsByItsRestitution) {
  for (const double e : {0.3, 0.8}) {
    for (const Vec3d size : {Vec3d{0.2, 0.2, 0.2}, Vec3d{0.4, 0.3, 0.02}}) {
      ContactScene s;
      s.add_floor();
      s.add_box("box", 1, size, {0, 0, 0.5 + size.z / 2});
      s.material().restitution = e;
      ContactRun run(s.scene, 1e-3);
      expect_near("flat box of height " + std::to_string(size.z), std::sqrt(rebound(run, size.z / 2, 0.5)), e,
                  0.01 * e);
    }
  }
}

// Free bodies: momentum stays, and the relative rate returns by the restitution.
// Where many bodies touch, impacts begin within steps (ContactRules::uncut_step). Each ball returns as it
// would alone, whatever the order of the bodies.
TEST(Contact, ManyImpactsAtOnceReturnTheirShare) {
  constexpr int resting = 10, falling = 40;
  for (const double e : {0.1, 0.5, 0.9}) {
    std::vector<double> returned(falling), place(falling);
    for (const bool reversed : {false, true}) {
      ContactScene s;
      s.add_floor();
      s.material().restitution = e;
      s.material().stiffness = 1e8;
      const auto height = [](int k) { return 0.3 + 5e-6 * k * (1 + 0.01 * k); };  // of the fall
      const auto add = [&](int k) {
        const bool rests = k >= falling;
        s.add_ball("ball_" + std::to_string(k), 1, 0.1, {k * 0.3, 0, 0.1 + (rests ? -g / 1e8 : height(k))});
      };
      for (int i = 0; i < resting + falling; ++i) add(reversed ? resting + falling - 1 - i : i);
      ContactRun run(s.scene, 1e-3);
      std::vector<double> best(falling, 0);
      for (int i = 0; i < 300; ++i) {
        run.advance(1);
        const auto seen = run.solver.observe();
        for (int k = 0; k < falling; ++k) {
          const auto& body = seen.bodies[static_cast<std::size_t>(reversed ? resting + falling - 1 - k : k)];
          const double v = body.twist.v_WB.z, z = body.pose.p_WB.z;
          if (v > 0) best[k] = std::max(best[k], z - 0.1 + v * v / (2 * g));
          if (!reversed) place[k] = z;
        }
      }
      double worst = 0, moved = 0;
      for (int k = 0; k < falling; ++k) {
        worst = std::max(worst, std::abs(std::sqrt(best[k] / height(k)) - e));
        const auto body = static_cast<std::size_t>(reversed ? resting + falling - 1 - k : k);
        moved = std::max(moved, std::abs(run.position(body).z - place[k]));
      }
      expect_near("e " + std::to_string(e) + ": largest error of the rate after over before", worst, 0,
                  0.01 * e);
      expect_near("e " + std::to_string(e) + ": by the order of bodies, m", moved, 0, 1e-9);
      expect_energy(run, 1e-9);
    }
  }
}

TEST(Contact, BallsCollide) {
  for (const double e : {0.5, 1.0}) {
    ContactScene s({0, 0, 0});
    const BodyId one = s.add_ball("one", 1, 0.1, {0, 0, 0});
    s.add_ball("two", 3, 0.2, {0.5, 0, 0});
    s.body(one).twist.v_WB = {2, 0, 0};
    s.material().restitution = e;
    ContactRun run(s.scene, 1e-2);
    run.advance(40);
    const double v1 = run.velocity(0).x, v2 = run.velocity(1).x;
    expect_near("momentum", v1 + 3 * v2, 2, 1e-9);
    expect_near("relative rate", v2 - v1, 2 * e, 0.01 * 2 * e);
  }
}

// Equal balls in a row: the last one leaves with the velocity of the first.
TEST(Contact, NewtonsCradle) {
  ContactScene s({0, 0, 0});
  for (int i = 0; i < 5; ++i) s.add_ball("ball" + std::to_string(i), 1, 0.1, {0.201 * i, 0, 0});
  s.body({0}).twist.v_WB = {1, 0, 0};
  ContactRun run(s.scene, 1e-3);
  run.advance(50);
  for (std::size_t i = 0; i < 4; ++i)
    expect_near("rate of ball " + std::to_string(i), run.velocity(i).x, 0, 0.01);
  expect_near("rate of the last", run.velocity(4).x, 1, 0.01);
}

// A ball on a free box, off its centre: linear and angular momentum stay.
TEST(Contact, BallMeetsABox) {
  for (const double y : {0.0, 0.05, 0.12}) {
    ContactScene s({0, 0, 0});
    const BodyId ball = s.add_ball("ball", 1, 0.05, {-0.3, y, 0.01});
    s.add_box("box", 2, {0.2, 0.2, 0.2}, {0, 0, 0});
    s.body(ball).twist.v_WB = {1, 0, 0};
    s.material() = {"stuff", 1e5, 0, 0, 0.8, 0.4};
    ContactRun run(s.scene, 1e-3);
    run.advance(400);
    const Vec3d p = run.velocity(0) + 2 * run.velocity(1);
    const double J = 0.4 * 0.05 * 0.05, J_box = 2. / 12 * 0.08;
    const Vec3d L = cross(run.position(0), run.velocity(0)) + J * run.spin(0) +
                    2 * cross(run.position(1), run.velocity(1)) + J_box * run.spin(1);
    expect_near("momentum at y = " + std::to_string(y), p.x, 1, 1e-9);
    expect_near("across", norm(Vec3d{0, p.y, p.z}), 0, 1e-9);
    expect_near("angular momentum", norm(L - Vec3d{0, 0.01, -y}), 0, 1e-6);
    EXPECT_LT(run.velocity(0).x, 0.5);
  }
}

// Shapes of all kinds that fall on a box, a capsule and a hull that are at rest: momentum stays where nothing
// holds them, and energy falls.
TEST(Contact, EveryPairOfShapesCollides) {
  const scene::SphereShape ball{.1};
  const scene::BoxShape box{{.2, .24, .16}, {}};
  const scene::CapsuleShape rod{.06, .2, {}};
  const scene::HullShape hull{
      {{0, 0, -.1}, {.1, .03, .06}, {-.1, .04, .06}, {0, -.1, .08}, {.02, .05, .12}}, {}, 1};
  const std::vector<std::pair<const char*, scene::Geometry>> shapes{
      {"sphere", ball}, {"box", box}, {"capsule", rod}, {"hull", hull}};
  for (const auto& [one, first] : shapes)
    for (const auto& [two, second] : shapes) {
      double worst = 0, largest = -1, closest = 1;
      int touched = 0;
      for (int i = 0; i < 6; ++i) {
        ContactScene s({0, 0, 0});
        const BodyId a = s.add("a", 1, {4e-3, 5e-3, 6e-3}, {-.5, .02 * (i % 3), .03 * (i % 2)}, first);
        const BodyId b = s.add("b", 2, {8e-3, 9e-3, 7e-3}, {0, 0, 0}, second);
        std::mt19937_64 random(static_cast<std::uint64_t>(i));
        s.body(a).pose.q_WB = test::random_rotation(random);
        s.body(b).pose.q_WB = test::random_rotation(random);
        s.body(a).twist.v_WB = {2, 0, 0};
        s.material() = {"stuff", 1e6, 0, 0, 0.6, 0.3};
        ContactRun run(s.scene, 2e-3);
        run.advance(250);
        const Vec3d v = run.velocity(0) + 2 * run.velocity(1);
        worst = std::max(worst, norm(v - Vec3d{2, 0, 0}));
        largest = std::max(largest, (run.largest_energy - run.start_energy) / run.start_energy);
        touched += norm(run.velocity(1)) > 0.1;
        closest = std::min(closest, norm(run.position(1) - run.position(0)));
      }
      std::printf("  %-8s on %-8s: %d of 6 touched; momentum to %.1e, energy above the start %.1e\n", one,
                  two, touched, worst, largest);
      EXPECT_GE(touched, 4);
      EXPECT_LT(worst, 1e-8);
      EXPECT_LT(largest, 1e-3);
    }
}

// Rounding decides which ends of two rods of one length are beyond the other's.
TEST(Contact, ParallelCapsulesOfOneLengthExchangeTheirVelocity) {
  for (const Vec3d turn : {Vec3d{0, 0, 0}, Vec3d{0.3, 0.2, 0.1}, Vec3d{-1, 2, 0.7}}) {
    const Quat q = exp(turn);
    ContactScene scene({0, 0, 0});
    const Vec3d across = q.rotate({1, 0, 0});
    const scene::CapsuleShape rod{0.05, 0.2, {}};
    const BodyId a = scene.add("a", 1, {0.004, 0.004, 0.00125}, {0, 0, 0}, rod),
                 b = scene.add("b", 1, {0.004, 0.004, 0.00125}, 0.3 * across, rod);
    for (const BodyId body : {a, b}) scene.body(body).pose.q_WB = q;
    scene.body(b).twist.v_WB = -3.0 * across;
    ContactRun run(scene.scene, 0.1);
    run.advance(2);
    expect_near("velocity of the one that was hit", norm(run.velocity(0) + 3.0 * across), 0, 2e-3);
    expect_near("velocity of the other", norm(run.velocity(1)), 0, 2e-3);
    expect_near("spins", norm(run.spin(0)) + norm(run.spin(1)), 0, 1e-6);
  }
}

// Falls of a share of the radius: impacts from lower than 1e-2 have longer steps.
TEST(Contact, LowImpactsReturnTheirShare) {
  constexpr double R = 0.05, e = 0.5;
  for (const double share : {1., 1e-1, 1e-2, 1e-3, 3e-4}) {
    ContactScene s;
    s.add_floor();
    s.add_ball("ball", 1, R, {0, 0, R * (1 + share)});
    s.material() = {"stuff", 1e10, 0, 0, e, 0.5};
    const double rate = std::sqrt(2 * g * share * R), fall = rate / g;
    ContactRun run(s.scene, fall / 50);
    run.advance(60);
    const double z = run.position().z - R, v = run.velocity().z;
    ASSERT_GT(z, 0);
    expect_near("rebound over e times the rate, fall of " + std::to_string(share) + " R",
                std::sqrt(v * v + 2 * g * z) / (e * rate), 1, 1e-2);
  }
}

// What points dissipate is integrated as accurately as the motion.
TEST(Contact, TheEnergyOfAnImpactCloses) {
  for (const double e : {1.0, 0.5, 0.1, 0.01}) {
    ContactScene s;
    s.add_floor();
    s.add_ball("ball", 1, 0.05, {0, 0, 0.55});
    s.material() = {"stuff", 1e6, 0, 0, e, 0.5};
    ContactRun run(s.scene, 1e-3);
    run.advance(500);
    const nlohmann::json facts = run.facts();
    expect_near(
        "residual of the balance over the energy that moves",
        facts.at("mbd_largest_energy_balance_J").get<double>() / facts.at("mbd_energy_scale_J").get<double>(),
        0, 6e-3);
  }
}

// What the steps leave out is that of the steps: the force that begins at the end of a long one is no part of
// it.
TEST(Contact, ABeginningContactIsNoErrorOfTheStepBefore) {
  ContactScene s;
  s.add_floor();
  s.add_ball("ball", 1, 0.1, {0, 0, 0.6});
  s.body({0}).twist.v_WB = {2, 0, 0};
  s.material() = {"stuff", 1e5, 0, 0, 0.5, 0.4};
  ContactRun run(s.scene, 5e-3);
  run.advance(90);
  expect_near("sum of the local errors over the size of the machine",
              run.facts().at("mbd_local_error_sum").get<double>(), 0, 1e-3);
}

}  // namespace
}  // namespace tandem::mbd
