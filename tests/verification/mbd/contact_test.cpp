// Bodies that touch: friction, mechanisms, and what every contact has to hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/error.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

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

// Painleve's rod of 1 m: it slides on its lower end.
scene::Scene painleves_rod(double speed, double angle, double friction) {
  ContactScene s;
  s.add_floor();
  const double half = 0.5;
  const BodyId rod = s.add("rod", 1, {1. / 12, 1. / 12, 1e-4}, {0, 0, half * std::sin(angle) + 0.01 - 1e-5},
                           scene::CapsuleShape{0.01, 2 * half, {}});
  const double tilt = std::numbers::pi / 2 - angle;
  s.body(rod).pose.q_WB = {std::cos(tilt / 2), 0, std::sin(tilt / 2), 0};
  s.body(rod).twist.v_WB = {speed, 0, 0};
  s.material() = {"stuff", 1e7, 0, 0, 0.1, friction};
  return s.scene;
}

// With less friction than that it slides on. What friction takes is what the energy lacks, with steps that
// are much longer than the period of the contact as well.
TEST(Contact, FrictionOfPainlevesRodIsBalanced) {
  for (const double friction : {0.4, 0.8, 1.2})
    for (const double speed : {-3., 3.})
      for (const double angle : {1.1, 1.2}) {
        double fine = 0;
        for (const double step : {1e-4, 5e-4, 1e-3, 2e-3}) {
          ContactRun run(painleves_rod(speed, angle, friction), step);
          run.advance(static_cast<int>(std::lround(0.2 / step)));
          const nlohmann::json facts = run.facts();
          const double lost = facts.at("mbd_dissipated_J");
          if (step == 1e-4) fine = lost;
          const std::string what = "friction " + std::to_string(friction).substr(0, 3) + ", " +
                                   std::to_string(static_cast<int>(speed)) + " m/s, step " +
                                   std::to_string(step).substr(0, 6) + " s: ";
          expect_near(what + "dissipated [J]", lost, fine, 5e-3 * fine);
          expect_near(what + "balance / scale",
                      facts.at("mbd_largest_energy_balance_J").get<double>() /
                          facts.at("mbd_energy_scale_J").get<double>(),
                      0, 2e-3);
        }
      }
}

// With much friction there are positions from which a rigid rod cannot go on to slide. Here it jams at its
// lower end, takes off, and never gains energy.
TEST(Contact, PainlevesRodEnds) {
  for (const double speed : {-3., 3.}) {
    ContactRun run(painleves_rod(speed, 1.1, 2.5), 1e-3);
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
