#include "protocol/checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "protocol/progress.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol::test {
namespace {

using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

void expect_violation(Violation violation, const std::string& text, auto&& f) {
  try {
    f();
    ADD_FAILURE() << "accepted, expected: " << text;
  } catch (const ProtocolError& e) {
    EXPECT_EQ(e.violation(), violation) << e.what();
    EXPECT_THAT(e.what(), HasSubstr(text));
  }
}

MotionSet motions(std::initializer_list<std::uint32_t> bodies) {
  MotionSet set;
  set.window = {0, {0}, {1000}};
  for (const std::uint32_t body : bodies) set.bodies.emplace_back().body = body;
  return set;
}
LoadSet loads(std::initializer_list<std::uint32_t> bodies) {
  LoadSet set;
  set.window = {0, {0}, {1000}};
  for (const std::uint32_t body : bodies) set.bodies.emplace_back().body = body;
  set.account.micro_steps = 4;
  set.account.micro_step = 250e-9;
  return set;
}

TEST(Responses, AreInTheOrderOfBodiesAndTimes) {
  TangentSet set;
  set.responses = {{.body = 1, .time = 0}, {.body = 1, .time = 2}, {.body = 2, .time = 1}};
  check_values(set);
  expect_violation(Violation::wrong_time, "body 1: the response after 2 s is not in the order", [&] {
    TangentSet bad = set;
    bad.responses[0].time = 2;
    check_values(bad);
  });
  expect_violation(Violation::not_positive, "time is -1 s, below 0", [&] {
    TangentSet bad = set;
    bad.responses[0].time = -1;
    check_values(bad);
  });
}

TEST(Values, GoodOnesPass) {
  check_values(motions({0, 5}));
  check_values(loads({0, ground.value}));
  check_account(loads({}));
}

// Every number of every record in turn, by position in its bytes: each must be checked.
template <class Record>
void every_number_is_checked(auto&& check, Record record) {
  for (std::size_t at = 8; at + 8 <= sizeof(Record); at += 8)
    for (const double bad : {nan, inf, -inf}) {
      Record spoiled = record;
      std::memcpy(reinterpret_cast<std::byte*>(&spoiled) + at, &bad, 8);
      try {
        check(spoiled);
        ADD_FAILURE() << "the number at byte " << at << " may be " << bad;
      } catch (const ProtocolError& e) {
        EXPECT_EQ(e.violation(), Violation::not_finite);
        EXPECT_EQ(e.code(), ErrorCode::numerics);
      }
    }
}

TEST(Values, EveryNumberOfAMotionIsChecked) {
  every_number_is_checked(
      [](const BodyMotion& m) {
        MotionSet set;
        set.bodies = {m};
        check_values(set);
      },
      BodyMotion{});
}
TEST(Values, EveryNumberOfALoadIsChecked) {
  every_number_is_checked(
      [](const BodyLoad& l) {
        LoadSet set;
        set.bodies = {l};
        check_values(set);
      },
      BodyLoad{});
}
TEST(Values, EveryNumberOfAResultIsChecked) {
  every_number_is_checked([](const BodyState& b) { check_values(BodiesFrame{{}, {b}, {}, 0}); }, BodyState{});
  every_number_is_checked(
      [](const JointState& j) {
        check_values(BodiesFrame{{}, {}, {j}, 0});
      },
      JointState{});
  expect_violation(Violation::not_finite, "energy is nan", [] {
    check_values(BodiesFrame{{}, {}, {}, nan});
  });
  expect_violation(Violation::not_finite, "element column 1: value is nan", [] {
    check_values(BodiesFrame{{}, {}, {}, 0, {1, nan}});
  });
}

TEST(Values, TheSentenceNamesBodyFieldAndValue) {
  MotionSet set = motions({2, 7});
  set.bodies[1].end_pose.p_WB.z = inf;
  expect_violation(Violation::not_finite, "body 7: end_pose.p_WB is (0, 0, inf), not finite",
                   [&] { check_values(set); });
  LoadSet ground_load = loads({ground.value});
  ground_load.bodies[0].work = nan;
  expect_violation(Violation::not_finite, "ground: work is nan", [&] { check_values(ground_load); });
  LoadSet account = loads({});
  account.account.momentum_end.x = nan;
  expect_violation(Violation::not_finite, "account: momentum_end is (nan, 0, 0)",
                   [&] { check_values(account); });
}

TEST(Checks, TimesOfAWindowAreNotBeforeTheStart) {
  MotionSet motion = motions({0});
  motion.window.begin = {std::numeric_limits<std::int64_t>::min()};
  expect_violation(Violation::wrong_time, "window.begin is -9223372036854775808 ns, before the start",
                   [&] { check_values(motion); });
  LoadSet load = loads({0});
  load.window.end = {-1};
  expect_violation(Violation::wrong_time, "window.end is -1 ns", [&] { check_values(load); });
}

TEST(Values, AQuaternionIsOfUnitLengthWithin1em9) {
  MotionSet set = motions({1});
  set.bodies[0].begin_pose.q_WB.w = 1 + 0.9e-9;
  check_values(set);
  set.bodies[0].begin_pose.q_WB.w = 1 + 1.1e-9;
  expect_violation(Violation::not_unit, "body 1: begin_pose.q_WB has the norm 1.0000000011",
                   [&] { check_values(set); });
  set.bodies[0].begin_pose.q_WB = {0, 0, 0, 0};
  expect_violation(Violation::not_unit, "norm 0", [&] { check_values(set); });
}

TEST(Values, AReservedFieldIsZero) {
  MotionSet set = motions({1});
  set.bodies[0].reserved = 1;
  expect_violation(Violation::bad_header, "body 1: reserved", [&] { check_values(set); });
}

TEST(Values, MicroStepsFillTheWindow) {
  LoadSet set = loads({});
  set.account.micro_steps = 0;
  expect_violation(Violation::not_positive, "micro_steps is 0", [&] { check_account(set); });
  set = loads({});
  set.account.micro_step = -1;
  expect_violation(Violation::not_positive, "micro_step is -1 s", [&] { check_account(set); });
  set.account.micro_step = 200e-9;
  expect_violation(Violation::wrong_time, "do not fill the window", [&] { check_account(set); });
}

TEST(Values, EnergyAndOverlapAreNotNegative) {
  LoadSet set = loads({});
  set.account.kinetic_energy = -5;
  expect_violation(Violation::not_positive, "kinetic_energy is -5 J", [&] { check_account(set); });
  set = loads({});
  set.account.max_overlap_ratio = -1;
  expect_violation(Violation::not_positive, "max_overlap_ratio is -1", [&] { check_account(set); });
}

TEST(Values, ParticlesAreCompleteAscendingAndFinite) {
  const ParticlesFrame good{{},        {1, 4}, {1, 2, 3, 4, 5, 6}, {0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0},
                            {.1f, .2f}};
  check_values(good);
  ParticlesFrame bad = good;
  bad.spin.pop_back();
  expect_violation(Violation::bad_index, "spin holds 5 numbers for 2 particles, expected 6",
                   [&] { check_values(bad); });
  bad = good;
  bad.id = {4, 4};
  expect_violation(Violation::bad_index, "id[1] is 4 after 4", [&] { check_values(bad); });
  bad = good;
  bad.position[4] = nan;
  expect_violation(Violation::not_finite, "particle 4: position is nan", [&] { check_values(bad); });
  bad = good;
  bad.radius[0] = 0;
  expect_violation(Violation::not_positive, "particle 1: radius is 0", [&] { check_values(bad); });
}

TEST(Values, EveryNumberOfALargeFrameIsFinite) {
  constexpr std::uint32_t n = 101;
  ParticlesFrame good;
  for (std::uint32_t id = 0; id < n; ++id) good.id.push_back(id);
  good.position.assign(3 * n, -1e300);
  good.velocity.assign(3 * n, 3e38f);
  good.spin.assign(3 * n, -1e-45f);
  good.radius.assign(n, 1);
  check_values(good);
  for (std::size_t i = 0; i < 3 * n; ++i) {
    const std::string particle = "particle " + std::to_string(i / 3) + ": ";
    ParticlesFrame bad = good;
    bad.position[i] = i % 2 == 0 ? nan : -inf;
    expect_violation(Violation::not_finite, particle + "position is ", [&] { check_values(bad); });
    bad = good;
    bad.velocity[i] = static_cast<float>(i % 2 == 0 ? -nan : inf);
    expect_violation(Violation::not_finite, particle + "velocity is ", [&] { check_values(bad); });
  }
}

TEST(Values, MeshesHaveTheirVertices) {
  Configuration c;
  c.meshes = {{"hopper", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}}}};
  expect_violation(Violation::bad_index, "mesh hopper: triangles[0] has the vertex 3 of 3",
                   [&] { check_values(c); });
  c.meshes[0].mesh.triangles[0][2] = 2;
  check_values(c);
  c.meshes[0].mesh.vertices[1].y = nan;
  expect_violation(Violation::not_finite, "mesh hopper: vertices[1]", [&] { check_values(c); });
}

TEST(Values, ATangentNamesBodyRowAndColumn) {
  TangentSet tangents;
  tangents.bodies.resize(1);
  tangents.bodies[0].body = 5;
  check_values(tangents);
  tangents.bodies[0].damping[8] = nan;
  expect_violation(Violation::not_finite, "body 5: damping[1][2]", [&] { check_values(tangents); });
}

TEST(Values, AControlInputIsFinite) {
  check_values(Checkpoint{0, {0}, "/a/state.h5"});
  expect_violation(Violation::not_allowed, "path is 'state.h5', not absolute", [] {
    check_values(Checkpoint{0, {0}, "state.h5"});
  });
  expect_violation(Violation::wrong_time, "time is -1 ns", [] {
    check_values(Checkpoint{0, {-1}, "/a/state.h5"});
  });
  check_values(ControlSet{{0}, {1, -2}});
  expect_violation(Violation::not_finite, "control input 1: value is nan, not finite", [] {
    check_values(ControlSet{{0}, {1, std::nan("")}});
  });
}

TEST(Boundary, EachBodyOnceAndNoOther) {
  BoundaryBodies bodies;
  EXPECT_FALSE(bodies.known());
  bodies.assign(motions({4, 2}).bodies);
  EXPECT_TRUE(bodies.known());
  bodies.expect_all(motions({2, 4}).bodies);
  bodies.expect_some(loads({4, ground.value}).bodies);
  bodies.expect_some(std::vector<BodyLoad>{});
  bodies.expect_some(std::vector<BodyResponse>{{.body = 2, .time = 1}, {.body = 2, .time = 2}, {.body = 4}});
  expect_violation(Violation::unknown_body, "body 3 is not one of the 2",
                   [&] { bodies.expect_some(std::vector<BodyResponse>{{.body = 3}}); });
  std::vector<BodyTangent> tangents(2);
  tangents[0].body = tangents[1].body = 4;
  expect_violation(Violation::repeated_body, "body 4 appears twice", [&] { bodies.expect_some(tangents); });
  expect_violation(Violation::missing_body, "body 4 is missing",
                   [&] { bodies.expect_all(motions({2}).bodies); });
  expect_violation(Violation::unknown_body, "body 3 is not one of the 2", [&] {
    bodies.expect_all(motions({2, 3}).bodies);
  });
  expect_violation(Violation::repeated_body, "body 2 appears twice", [&] {
    bodies.expect_all(motions({2, 2}).bodies);
  });
  expect_violation(Violation::unknown_body, "ground", [&] {
    bodies.expect_all(motions({2, ground.value}).bodies);
  });
  expect_violation(Violation::unknown_body, "body 0", [&] { bodies.expect_some(loads({0}).bodies); });
  expect_violation(Violation::repeated_body, "ground appears twice", [&] {
    bodies.expect_some(loads({ground.value, ground.value}).bodies);
  });
  expect_violation(Violation::repeated_body, "body 1 appears twice", [&] {
    bodies.assign(motions({1, 1}).bodies);
  });
  expect_violation(Violation::unknown_body, "ground has no motion",
                   [&] { bodies.assign(motions({ground.value}).bodies); });
}

TEST(ProgressInTime, WindowsFollowOneAnother) {
  Progress p;
  p.expect({0, {0}, {10}});
  expect_violation(Violation::wrong_window, "window.index is 1, expected 0", [&] {
    p.expect({1, {0}, {10}});
  });
  expect_violation(Violation::wrong_time, "window.begin is 5 ns", [&] { p.expect({0, {5}, {10}}); });
  expect_violation(Violation::wrong_time, "not after", [&] { p.expect({0, {0}, {0}}); });
  expect_violation(Violation::wrong_time, "not after", [&] { p.expect({0, {0}, {-1}}); });
  p.complete({0, {0}, {10}});
  p.expect({1, {10}, {11}});
  p.expect_now({10});
  expect_violation(Violation::wrong_time, "time is 11 ns, expected 10 ns", [&] { p.expect_now({11}); });
  const Window w{1, {10}, {11}};
  p.expect_same(w, w);
  expect_violation(Violation::wrong_window, "ordered was 1", [&] { p.expect_same({2, {10}, {11}}, w); });
  expect_violation(Violation::wrong_time, "window.begin is 9 ns", [&] { p.expect_same({1, {9}, {11}}, w); });
  expect_violation(Violation::wrong_time, "window.end is 12 ns", [&] { p.expect_same({1, {10}, {12}}, w); });
}

TEST(ProgressInTime, ARestoreGoesBackAndCountsTheAttempt) {
  Progress p;
  expect_violation(Violation::not_allowed, "restore", [&] { p.restore(); });
  p.save();
  for (std::uint32_t attempt = 1; attempt < 4; ++attempt) {
    p.complete({0, {0}, {10}});
    EXPECT_EQ(p.window(), 1u);
    EXPECT_EQ(p.iteration(), 0u);
    p.restore();
    EXPECT_EQ(p.window(), 0u);
    EXPECT_EQ(p.iteration(), attempt);
    EXPECT_EQ(p.now().count, 0);
  }
}

}  // namespace
}  // namespace tandem::protocol::test
