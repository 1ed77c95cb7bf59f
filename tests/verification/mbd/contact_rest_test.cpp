// Bodies that rest on each other, and that come to rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

// Balls on each other: each contact is as deep as the weight above asks for, and nothing moves.
TEST(Contact, StackOfTenBalls) {
  ContactScene s;
  s.add_floor();
  for (int i = 0; i < 10; ++i) s.add_ball("ball" + std::to_string(i), 1, 0.1, {0, 0, 0.1 + 0.2 * i});
  s.material() = {"stuff", 1e5, 0, 0, 0.1, 0.5};
  ContactRun run(s.scene, 1e-2);
  run.advance(150);
  expect_near("largest error of the ten heights [m]", error_of_heights(run, 10, 0.1, 0.2, 1e5), 0, 1e-8);
  const Vec3d top = run.position(9);
  run.advance(500);
  expect_near("displacement of the top in 5 s [m]", norm(run.position(9) - top), 0, 1e-8);
}

// Boxes on each other: four points between two faces, each with a quarter of the weight above.
TEST(Contact, StackOfTenBoxes) {
  ContactScene s;
  s.add_floor();
  for (int i = 0; i < 10; ++i)
    s.add_box("box" + std::to_string(i), 1, {0.2, 0.3, 0.1}, {0, 0, 0.05 + 0.1 * i});
  s.material() = {"stuff", 1e5, 0, 0, 0.1, 0.5};
  ContactRun run(s.scene, 1e-2);
  run.advance(100);
  expect_near("largest error of the ten heights [m]", error_of_heights(run, 10, 0.05, 0.1, 4e5), 0, 1e-8);
  const Vec3d top = run.position(9);
  run.advance(200);
  expect_near("displacement of the top in 2 s [m]", norm(run.position(9) - top), 0, 1e-9);
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

// Edges that lie on each other do not cross: the part of a face above an equal one has four corners, and
// eight once the boxes are turned against each other.
TEST(Contact, EdgesThatLieOnEachOtherDoNotCross) {
  constexpr double height = 0.1, depth = 1e-6;
  for (const double turn : {0., 1e-6, 5e-5, 1e-2}) {
    ContactScene s({0, 0, 0});
    s.add_box("lower", 1, {0.2, 0.2, height}, {0, 0, 0});
    const BodyId upper = s.add_box("upper", 1, {0.2, 0.2, height}, {0, 0, height - depth});
    s.body(upper).pose.q_WB = exp(Vec3d{0, 0, turn});
    const ContactRun run(s.scene, 1e-3);
    expect_near("points of equal faces, turned by " + std::to_string(turn) + " rad",
                static_cast<double>(run.solver.state().contacts.size()), turn < 1e-4 ? 4 : 8, 0);
  }
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

// The long runs of these tests.
bool soak() {
  return std::getenv("TANDEM_SOAK") != nullptr;
}

TEST(ContactSoak, AThousandBoxesStayAtRest) {
  if (!soak()) GTEST_SKIP() << "TANDEM_SOAK is not set";
  stay_at_rest(100, 6000);
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

TEST(Contact, RandomDropsStayInTheirBox) {
  for (const std::uint64_t seed : {1, 2, 3}) EXPECT_LT(drop(seed, 60).fastest, 10);
  EXPECT_EQ(drop(1, 40).hash, drop(1, 40).hash);
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

}  // namespace
}  // namespace tandem::mbd
