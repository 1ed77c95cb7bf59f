// Bodies that touch, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/error.hpp"
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

// Beyond the friction angle the block slides with g (sin a - mu cos a), below it stays for an hour.
TEST(Contact, BlockOnASlope) {
  const double mu = 0.5;
  for (const double share : {0.99, 1.01}) {
    const double angle = share * std::atan(mu);
    ContactScene s({g * std::sin(angle), 0, -g * std::cos(angle)});
    s.add_floor();
    s.add_box("block", 2, {0.2, 0.2, 0.1}, {0, 0, 0.05});
    s.material() = {"stuff", 1e6, 0, 0, 0.5, mu};
    if (share < 1) {
      ContactRun run(s.scene, 0.5);
      run.advance(300);
      const Vec3d begin = run.position();
      run.advance(6900);
      std::printf("  the block has slid by %g m before it rests\n", begin.x);
      EXPECT_LT(begin.x, 1e-3);
      expect_near("displacement in an hour", norm(run.position() - begin), 0, 1e-12);
      expect_near("speed after an hour", norm(run.velocity()), 0, 1e-12);
    } else {
      ContactRun run(s.scene, 1e-2);
      run.advance(100);
      const double begin = run.position().x, v = run.velocity().x;
      run.advance(100);
      const double a = g * (std::sin(angle) - mu * std::cos(angle));
      expect_near("acceleration from 1 s to 2 s", run.velocity().x - v, a, 0.01 * a);
      expect_near("distance from 1 s to 2 s", run.position().x - begin, v + a / 2, 0.01 * (v + a / 2));
    }
  }
}

TEST(Contact, BlockSlidesToAStop) {
  for (const double step : {1e-2, 1e-3}) {
    ContactScene s;
    s.add_floor();
    const BodyId block = s.add_box("block", 2, {0.4, 0.4, 0.05}, {0, 0, 0.025});
    s.body(block).twist.v_WB = {2, 0, 0};
    s.material() = {"stuff", 1e6, 0, 0, 0.5, 0.3};
    ContactRun run(s.scene, step);
    run.advance(static_cast<int>(1.5 / step));
    expect_near("distance in steps of " + std::to_string(step), run.position().x, 4 / (2 * 0.3 * g),
                5e-3 * 4 / (2 * 0.3 * g));
    expect_near("speed", norm(run.velocity()), 0, 1e-4);
    expect_energy(run, 1e-9);
    const nlohmann::json facts = run.facts();
    expect_near("balance of energy", facts.at("mbd_energy_balance_J").get<double>(), 0, 0.01 * 4);
  }
}

// A ball that starts without a spin slides until it rolls, with 5/7 of its speed.
TEST(Contact, BallRollsAfterItHasSlid) {
  for (const double step : {1e-2, 1e-3}) {
    ContactScene s;
    s.add_floor();
    const BodyId ball = s.add_ball("ball", 1, 0.1, {0, 0, 0.1});
    s.body(ball).twist.v_WB = {1, 0, 0};
    s.material() = {"stuff", 1e6, 0, 0, 0.5, 0.2};
    ContactRun run(s.scene, step);
    const double time = 2. / 7 / (0.2 * g);
    run.advance(static_cast<int>(std::ceil(1.5 * time / step)));
    expect_near("speed in steps of " + std::to_string(step), run.velocity().x, 5. / 7, 2e-3);
    expect_near("spin", run.spin().y, 5. / 7 / 0.1, 2e-2);
    const double x = run.position().x, now = static_cast<double>(run.done) * step;
    run.advance(static_cast<int>(1 / step));
    expect_near("distance rolled in 1 s", run.position().x - x, 5. / 7, 2e-3);
    expect_near("distance until then", x, time - 0.1 * g * time * time + 5. / 7 * (now - time), 2e-3);
    expect_energy(run, 1e-9);
  }
}

// Free bodies: momentum stays, and the relative rate returns by the restitution.
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

// Balls on each other: each contact is as deep as the weight above asks for, and nothing moves.
TEST(Contact, StackOfTenBalls) {
  ContactScene s;
  s.add_floor();
  for (int i = 0; i < 10; ++i) s.add_ball("ball" + std::to_string(i), 1, 0.1, {0, 0, 0.1 + 0.2 * i});
  s.material() = {"stuff", 1e5, 0, 0, 0.1, 0.5};
  ContactRun run(s.scene, 1e-2);
  run.advance(400);
  double height = 0.1, worst = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    height -= static_cast<double>(10 - i) * g / 1e5;
    worst = std::max(worst, std::abs(run.position(i).z - height));
    height += 0.2;
  }
  expect_near("largest error of the ten heights [m]", worst, 0, 1e-8);
  const Vec3d top = run.position(9);
  run.advance(500);
  expect_near("displacement of the top in 5 s [m]", norm(run.position(9) - top), 0, 1e-8);
}

// A wheel that rolls against a step, without a rebound and without slip at its edge, keeps the angular
// momentum about the edge: it climbs a step of height s from the speed sqrt(2 g s / 1.4) 1.4 / (1.4 - s / R)
// on.
TEST(Contact, WheelClimbsAStep) {
  const double R = 0.3, step = 0.06;
  const double least = std::sqrt(2 * g * step / 1.4) * 1.4 / (1.4 - step / R);
  for (const double share : {0.95, 1.05}) {
    ContactScene s;
    s.add_floor();
    const BodyId wheel = s.add_ball("wheel", 2, R, {-0.8, 0, R});
    scene::Shape kerb;
    kerb.name = "kerb";
    kerb.use = scene::ShapeUse::contact;
    kerb.contact_material = 0;
    kerb.pose.p_WB = {1, 0, 0};
    kerb.geometry = scene::BoxShape{{2, 2, 2 * step}, {}};
    s.scene.contact->ground.push_back(kerb);
    s.material() = {"stuff", 1e7, 0, 0, 0.01, 5};
    s.body(wheel).twist = {{share * least, 0, 0}, {0, share * least / R, 0}};
    ContactRun run(s.scene, 1e-3);
    run.advance(1500);
    std::printf("  %.2f of the least speed of %.4f m/s: at x = %.3f m, z = %.3f m after 1.5 s\n", share,
                least, run.position().x, run.position().z);
    expect_near("height", run.position().z, share > 1 ? R + step : R, 1e-3);
    EXPECT_EQ(run.position().x > 0, share > 1);
    expect_energy(run, 1e-9);
  }
}

// A parallel four-bar whose crank a torque presses against a stop: the stop bears the torque over its lever.
TEST(Contact, FourBarPressedAgainstAStop) {
  ContactScene s({0, 0, 0});
  const double torque = 30, lever = 0.5, k = 1e6;
  const auto bar = [&](const char* name, Vec3d position) {
    return machines::add_body(s.scene, name, 1, {0.02, 0.02, 0.02}, position);
  };
  const BodyId crank = s.add_ball("crank", 1, 0.05, {0, 0, 0.5});
  const BodyId coupler = bar("coupler", {0.5, 0, 1}), rocker = bar("rocker", {1, 0, 0.5});
  const auto hinge = [&](const char* name, BodyId parent, BodyId child, Vec3d position) {
    machines::add_joint(s.scene, name, scene::JointType::revolute, parent, child, position, {0, 1, 0});
  };
  hinge("a", ground, crank, {0, 0, 0});
  hinge("b", crank, coupler, {0, 0, 1});
  hinge("c", coupler, rocker, {1, 0, 1});
  hinge("d", ground, rocker, {1, 0, 0});
  s.scene.mbd->forces.push_back(scene::Actuator{"press", JointId{0}, scene::ConstantMotion{torque, 0}});
  scene::Shape stop;
  stop.name = "stop";
  stop.use = scene::ShapeUse::contact;
  stop.contact_material = 0;
  stop.geometry = scene::PlaneShape{{0.06, 0, 0}, {-1, 0, 0}};
  s.scene.contact->ground.push_back(stop);
  s.material() = {"stuff", k, 0, 0, 0.2, 0};
  ContactRun run(s.scene, 1e-2);
  run.advance(500);
  const Vec3d p = run.position();
  // The crank leans by 0.01 / 0.5 rad: the normal force has the lever p.z.
  expect_near("force of the stop [N]", k * (p.x - 0.01), torque / p.z, 1e-4 * torque / lever);
  expect_near("speed [m/s]", norm(run.velocity()), 0, 1e-8);
}

// Painleve's rod: with much friction there are positions from which a rigid rod cannot go on to slide. Here
// it jams at its lower end, takes off, and never gains energy.
TEST(Contact, PainlevesRodEnds) {
  for (const double speed : {-3., 3.}) {
    ContactScene s;
    s.add_floor();
    const double half = 0.5, angle = 1.1;  // of the rod with the floor [rad]
    const BodyId rod = s.add("rod", 1, {1. / 12, 1. / 12, 1e-4}, {0, 0, half * std::sin(angle) + 0.01 - 1e-5},
                             scene::CapsuleShape{0.01, 2 * half, {}});
    const double tilt = std::numbers::pi / 2 - angle;
    s.body(rod).pose.q_WB = {std::cos(tilt / 2), 0, std::sin(tilt / 2), 0};
    s.body(rod).twist.v_WB = {speed, 0, 0};
    s.material() = {"stuff", 1e7, 0, 0, 0.1, 2.5};
    ContactRun run(s.scene, 1e-3);
    try {
      run.advance(300);
      std::printf("  sliding at %+.0f m/s: centre at (%.3f, %.3f) m after 0.3 s, %s steps\n", speed,
                  run.position().x, run.position().z, run.facts().at("mbd_steps").dump().c_str());
    } catch (const Error& error) {
      std::printf("  sliding at %+.0f m/s: %s\n", speed, error.what());
      EXPECT_EQ(error.code(), ErrorCode::numerics);
    }
    expect_energy(run, 1e-6);
  }
}

// Boxes on each other: four points between two faces, each with a quarter of the weight above.
TEST(Contact, StackOfTenBoxes) {
  ContactScene s;
  s.add_floor();
  for (int i = 0; i < 10; ++i)
    s.add_box("box" + std::to_string(i), 1, {0.2, 0.3, 0.1}, {0, 0, 0.05 + 0.1 * i});
  s.material() = {"stuff", 1e5, 0, 0, 0.1, 0.5};
  ContactRun run(s.scene, 1e-2);
  run.advance(160);
  double height = 0.05, worst = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    height -= static_cast<double>(10 - i) * g / 4e5;
    worst = std::max(worst, std::abs(run.position(i).z - height));
    height += 0.1;
  }
  expect_near("largest error of the ten heights [m]", worst, 0, 1e-8);
  const Vec3d top = run.position(9);
  run.advance(200);
  expect_near("displacement of the top in 2 s [m]", norm(run.position(9) - top), 0, 1e-9);
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

TEST(Contact, WithoutFrictionSlidingCostsAndGainsNothing) {
  ContactScene scene;
  scene.material().restitution = 0.5;
  scene.add_floor();
  const BodyId box = scene.add_box("box", 2, {0.2, 0.2, 0.1}, {0, 0, 0.05});
  scene.body(box).twist.v_WB = {1, 0, 0};
  ContactRun run(scene.scene, 0.1);
  run.advance(10);
  expect_near("way of the box", run.position().x, 1, 1e-9);
  expect_near("dissipated", run.facts()["mbd_dissipated_J"].get<double>(), 0, 1e-3);
}

std::string refusal(const scene::Scene& scene, int windows) {
  try {
    ContactRun run(scene, 0.1);
    run.advance(windows);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Contact, ShapesThatOverlapOrPassThroughEachOtherEndTheRun) {
  ContactScene overlapping;
  overlapping.add_floor();
  overlapping.add_ball("ball", 1, 0.1, {0, 0, 0.05});
  EXPECT_NE(refusal(overlapping.scene, 0).find("overlap at the start, by 0.05 m"), std::string::npos)
      << refusal(overlapping.scene, 0);
  ContactScene soft;
  soft.material().stiffness = 1e3;
  soft.add_floor();
  soft.add_ball("ball", 1, 0.05, {0, 0, 0.8});
  EXPECT_NE(refusal(soft.scene, 10).find("pass through each other"), std::string::npos)
      << refusal(soft.scene, 10);
}

// A ball that moves by a hundred times its size and that of the plate in a window meets the plate, at any
// height, or the run says that the plate is too soft for it.
TEST(Contact, AFastBallMeetsAThinPlate) {
  const auto scene = [](double stiffness, double height) {
    ContactScene s({0, 0, 0});
    s.material() = {"stuff", stiffness, 0, 0, 1, 0};
    s.add_box("plate", 1, {0.5, 0.5, 0.004}, {0, 0, 0});
    const BodyId ball = s.add_ball("ball", 1e-3, 0.005, {0, 0, height});
    s.body(ball).twist.v_WB = {0, 0, -100};
    return s.scene;
  };
  for (const double height : {0.3, 0.7, 0.913, 1.31}) {
    ContactRun run(scene(1e8, height), 1e-2);
    run.advance(2);
    expect_near("velocity of the ball after the impact [m/s]", run.velocity(1).z,
                100 * (1 - 1e-3) / (1 + 1e-3), 0.2);
  }
  EXPECT_NE(refusal(scene(1e4, 0.7), 2).find("pass through each other"), std::string::npos);
}

// The long runs of these tests.
bool soak() {
  return std::getenv("TANDEM_SOAK") != nullptr;
}

// A hundred bodies of mixed shapes fall into a box of planes and come to rest: none leaves it, none gains
// energy.
struct Drop {
  double lowest = 1, fastest = 0, farthest = 0;
  std::string hash;
};
Drop drop(std::uint64_t seed, int windows) {
  ContactScene s;
  s.add_floor();
  for (const Vec3d n : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, -1, 0}}) {
    scene::Shape wall = s.scene.contact->ground[0];
    wall.name += std::to_string(s.scene.contact->ground.size());
    wall.geometry = scene::PlaneShape{-0.8 * n, n};
    s.scene.contact->ground.push_back(wall);
  }
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> d(-0.05, 0.05);
  for (int i = 0; i < 100; ++i) {
    const Vec3d at{0.35 * (i % 4) - 0.52 + d(random), 0.35 * (i / 4 % 4) - 0.52 + d(random),
                   0.25 + 0.35 * (i / 16)};
    const std::string name = "body" + std::to_string(i);
    BodyId body{};
    if (i % 4 == 0) body = s.add_ball(name, 1, 0.1, at);
    if (i % 4 == 1) body = s.add_box(name, 1, {0.2, 0.16, 0.12}, at);
    if (i % 4 == 2) body = s.add(name, 1, {5e-3, 5e-3, 2e-3}, at, scene::CapsuleShape{.05, .15, {}});
    if (i % 4 == 3)
      body = s.add(name, 1, {4e-3, 4e-3, 4e-3}, at,
                   scene::HullShape{{{-.1, -.1, -.08}, {.1, -.1, -.08}, {0, .12, -.08}, {0, 0, .14}}, {}, 1});
    s.body(body).pose.q_WB = test::random_rotation(random);
  }
  s.material() = {"stuff", 1e5, 0, 0, 0.2, 0.4};
  ContactRun run(s.scene, 5e-3);
  run.advance(windows);
  Drop result;
  for (std::size_t b = 0; b < 100; ++b) {
    const Vec3d p = run.position(b);
    result.lowest = std::min(result.lowest, p.z);
    result.farthest = std::max({result.farthest, std::abs(p.x), std::abs(p.y)});
    result.fastest = std::max(result.fastest, norm(run.velocity(b)));
  }
  result.hash = run.facts().at("mbd_state_hash").get<std::string>();
  std::printf(
      "  seed %d after %g s: lowest centre %.4f m, farthest %.4f m, largest speed %.2e m/s, steps %s, energy "
      "above start %.1e, balance %.1e\n",
      static_cast<int>(seed), windows * 5e-3, result.lowest, result.farthest, result.fastest,
      run.facts().at("mbd_steps").dump().c_str(), (run.largest_energy - run.start_energy) / run.start_energy,
      run.facts().at("mbd_largest_energy_balance_J").get<double>() /
          run.facts().at("mbd_energy_scale_J").get<double>());
  std::fflush(stdout);
  EXPECT_GT(result.lowest, 0.03);
  EXPECT_LT(result.farthest, 0.77);
  EXPECT_LE(run.largest_energy, run.start_energy * (1 + 1e-6));
  return result;
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

// A ball that bounces, and rolls at last, in windows of 1 s: its steps resolve the rolling, so that it ends
// where it does in short windows, and what the steps leave out is small.
TEST(Contact, ABallRollsInLongWindows) {
  const auto end = [](double window) {
    ContactScene s;
    s.add_floor();
    s.add_ball("ball", 1, 0.1, {0, 0, 0.7});
    s.body({0}).twist.v_WB = {0.1, 0, 0};
    s.material() = {"stuff", 1e6, 0, 0, 0.9, 0.3};
    ContactRun run(s.scene, window);
    run.advance(static_cast<int>(std::lround(10 / window)));
    return std::pair{run.position(), run.facts()};
  };
  const auto [seen, facts] = end(1);
  const auto [right, unused] = end(1e-3);
  expect_near("steps that were taken in parts", facts.value("mbd_shortened_steps", 0), 0, 0);
  expect_near("sum of the local errors over the size of the machine",
              facts.at("mbd_local_error_sum").get<double>(), 0, 1e-3);
  expect_near("place at 10 s, windows of 1 s and of 1 ms [m]", norm(seen - right), 0, 1e-3);
}

// Bodies that overlap at the start fly apart, and the run says so; those that their weight presses do not.
TEST(Contact, AnOverlapAtTheStartIsNamed) {
  for (const bool at_rest : {false, true}) {
    ContactScene s;
    s.add_floor();
    s.add_box("box", 1, {0.2, 0.2, 0.1}, {0, 0, 0.05 - (at_rest ? g / 4e6 : 2e-3)});
    s.material() = {"stuff", 1e6, 0, 0, 0.5, 0.4};
    ContactRun run(s.scene, 5e-3);
    run.advance(20);
    const std::string warnings = run.facts().at("warnings").dump();
    std::printf("  %s\n", warnings.c_str());
    EXPECT_EQ(warnings.find("overlap at the start by 0.002 m") != std::string::npos, !at_rest);
  }
}

TEST(Contact, RandomDropsStayInTheirBox) {
  for (const std::uint64_t seed : {1, 2, 3}) EXPECT_LT(drop(seed, 60).fastest, 10);
  EXPECT_EQ(drop(1, 40).hash, drop(1, 40).hash);
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

// Of two corners of a face that are near to each other, one above the surface and one on it, each stays
// itself.
TEST(Contact, ACornerDoesNotTakeThePointOfItsNeighbour) {
  constexpr double k = 1e5, mass = 1, near = 4e-3, tilt = 0.02;
  for (const double side : {-1., 1.}) {
    ContactScene s;
    scene::Shape block;
    block.name = "block";
    block.use = scene::ShapeUse::contact;
    block.contact_material = 0;
    block.geometry = scene::BoxShape{{1, 1, 1}, {}};
    s.scene.contact->ground.push_back(block);
    // A prism on a slider that slopes by `tilt`, with two corners at each of its lower ends.
    std::vector<Vec3d> corners;
    for (const double x : {-0.1, -0.1 + near, 0.1 - near, 0.1})
      for (const double y : {-0.1, 0.1})
        for (const double z : {-0.05, 0.05})
          if (std::abs(x) > 0.099 ? y > 0 : true)
            corners.push_back({x, std::abs(x) > 0.099 ? 0.1 - near : y, z});
    const BodyId prism =
        s.add("prism", mass, {0.01, 0.01, 0.01}, {0, 0, 0.5 + 0.05 * std::cos(tilt) + 0.1 * std::sin(tilt)},
              scene::HullShape{corners, {}, 1});
    s.body(prism).pose.q_WB = {std::cos(tilt / 2), 0, side * std::sin(tilt / 2), 0};
    machines::add_joint(s.scene, "slider", scene::JointType::prismatic, ground, prism, {0, 0, 1});
    s.material() = {"stuff", k, 0, 0, 0.2, 0.4};
    ContactRun run(s.scene, 5e-3);
    run.advance(600);
    // It bounces twice.
    expect_near("points that came into contact", run.facts().at("mbd_body_contacts"), 3, 0);
    expect_near("speed [m/s]", norm(run.velocity()), 0, 1e-12);
  }
}

TEST(ContactSoak, RandomDropsComeToRest) {
  if (!soak()) GTEST_SKIP() << "TANDEM_SOAK is not set";
  // One seed and another duration, for machines with many cores.
  const auto given = [](const char* variable, std::uint64_t otherwise) {
    const char* value = std::getenv(variable);
    return value ? std::strtoull(value, nullptr, 10) : otherwise;
  };
  const std::uint64_t first = given("TANDEM_SEED", 1), last = given("TANDEM_SEED", 50);
  const int windows = static_cast<int>(given("TANDEM_WINDOWS", 12000));
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Drop once = drop(seed, windows);
    EXPECT_LT(once.fastest, 0.5);
    EXPECT_EQ(drop(seed, windows).hash, once.hash);
  }
}

// Stacks of ten boxes, each as deep in the one below as its load presses it.
void stay_at_rest(int stacks, int windows) {
  constexpr double k = 1e6, side = 0.2, height = 0.1;
  constexpr int high = 10;
  ContactScene s;
  s.add_floor();
  s.material() = {"stuff", k, 0, 0, 0.2, 0.4};
  for (int i = 0; i < stacks; ++i) {
    double z = 0;
    for (int j = 0; j < high; ++j) {
      z += height - g * (high - j) / (4 * k);
      s.add_box("box" + std::to_string(i) + "_" + std::to_string(j), 1, {side, side, height},
                {2 * side * (i % 10), 2 * side * (i / 10), z - height / 2});
    }
  }
  ContactRun run(s.scene, 1e-2);
  std::vector<Vec3d> begin;
  const auto count = static_cast<std::size_t>(stacks * high);
  for (std::size_t b = 0; b < count; ++b) begin.push_back(s.scene.mbd->bodies[b].pose.p_WB);
  run.advance(windows);
  const auto& bodies = run.solver.observe().bodies;
  double farthest = 0;
  for (std::size_t b = 0; b < count; ++b) farthest = std::max(farthest, norm(bodies[b].pose.p_WB - begin[b]));
  expect_near(
      "displacement of " + std::to_string(count) + " boxes in " + std::to_string(windows / 100.) + " s [m]",
      farthest, 0, 1e-7);
}

TEST(Contact, TwoHundredBoxesStayAtRest) {
  stay_at_rest(20, 20);
}

TEST(ContactSoak, AThousandBoxesStayAtRest) {
  if (!soak()) GTEST_SKIP() << "TANDEM_SOAK is not set";
  stay_at_rest(100, 6000);
}

// A tumbling box, a hull, a capsule and a ball on the floor, in other frames.
TEST(Contact, MovesTheSameInEveryFrame) {
  ContactScene s;
  s.add_floor();
  const BodyId box = s.add_box("box", 1, {0.2, 0.3, 0.1}, {0, 0, 0.5});
  s.add_ball("ball", 0.5, 0.1, {2, 0, 0.4});
  s.add("rod", 0.7, {0.01, 0.01, 0.001}, {4, 0, 0.5}, scene::CapsuleShape{0.05, 0.4, {}});
  s.add("tetrahedron", 0.6, {0.01, 0.01, 0.01}, {6, 0, 0.5},
        scene::HullShape{{{-0.1, -0.1, -0.1}, {0.2, 0, -0.1}, {0, 0.2, -0.1}, {0, 0, 0.2}}, {}, 1});
  s.body(box).twist = {{0.5, 0.2, 0}, {3, 1, -2}};
  s.body({1}).twist = {{1, 0, 0}, {0, 0, 9}};
  s.body({2}).twist = {{0, 0.5, 0}, {1, 2, 3}};
  s.body({3}).twist = {{0, 0, 0}, {-2, 1, 1}};
  s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.3};
  const auto end = [&](const scene::Scene& scene) {
    ContactRun run(scene, 1e-3);
    run.advance(400);
    expect_energy(run, 1e-9);
    std::vector<Vec3d> positions;
    for (std::size_t b = 0; b < 4; ++b) positions.push_back(run.position(b));
    return positions;
  };
  const std::vector<Vec3d> here = end(s.scene);
  std::mt19937_64 random(11);
  double worst = 0;
  for (int i = 0; i < 4; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {0, 0, 0}, {3. * i, -2, 1});
    const std::vector<Vec3d> there = end(test::moved(s.scene, motion));
    for (std::size_t b = 0; b < 4; ++b) worst = std::max(worst, norm(motion.point_back(there[b]) - here[b]));
  }
  expect_near("largest deviation in four frames [m]", worst, 0, 1e-6);
}

// Energy falls while bodies come to rest, and then nothing moves.
TEST(Contact, BoxComesToRest) {
  ContactScene s;
  s.add_floor();
  const BodyId box = s.add_box("box", 1, {0.2, 0.3, 0.1}, {0, 0, 0.5});
  s.body(box).twist = {{0.5, 0.2, 0}, {3, 1, -2}};
  s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.3};
  ContactRun run(s.scene, 1e-2);
  double last = run.start_energy, largest_rise = 0;
  for (int i = 0; i < 400; ++i) {
    run.advance(1);
    const double now = run.solver.observe().energy;
    largest_rise = std::max(largest_rise, now - last);
    last = now;
  }
  expect_near("largest rise of the energy in a window [J]", largest_rise, 0, 1e-3 * run.start_energy);
  const Vec3d rest = run.position();
  run.advance(1000);
  expect_near("displacement in the next 10 s [m]", norm(run.position() - rest), 0, 1e-9);
  expect_near("height", run.position().z, 0.05 - 9.81 / 4e5, 1e-7);
  std::printf("  %s\n", run.facts().at("mbd_steps").dump().c_str());
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

// The same motion after a rollback and from run to run.
TEST(Contact, GivesTheSameBits) {
  const auto hash = [](bool rollback) {
    ContactScene s;
    s.add_floor();
    const BodyId box = s.add_box("box", 1, {0.2, 0.3, 0.1}, {0, 0, 0.2});
    s.body(box).twist = {{0.5, 0.2, 0}, {3, 1, -2}};
    s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.3};
    ContactRun run(s.scene, 1e-2);
    run.advance(15);
    if (rollback) {
      run.solver.save();
      run.advance(5);
      run.done -= 5;
      run.solver.restore();
    }
    run.advance(20);
    return run.facts().at("mbd_state_hash").get<std::string>();
  };
  EXPECT_EQ(hash(false), hash(false));
  EXPECT_EQ(hash(false), hash(true));
}

}  // namespace
}  // namespace tandem::mbd
