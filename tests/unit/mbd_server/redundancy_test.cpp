// Redundant equations, for data of any number of digits and in any frame; the reactions that they leave
// undetermined.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "mbd_server/io/undetermined.hpp"
#include "mbd_server/solve/redundancy.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;
using testing::HasSubstr;

constexpr double of_data = 1e-4;

// Three parallel cranks of 1 m with a bar of 2 m; the third is longer by `longer`, and joined to the same
// bar.
scene::Scene three_cranks(double longer, double angle = 1) {
  scene::Scene scene = machines::empty({0, -9.81, 0});
  const Vec3d crank{std::cos(angle), std::sin(angle), 0};
  const BodyId bar = machines::add_body(scene, "bar", 2, {.1, .7, .7}, Vec3d{1, 0, 0} + crank);
  for (int i = 0; i < 3; ++i) {
    const Vec3d foot{1. * i, i == 2 ? -longer : 0, 0}, head = Vec3d{1. * i, 0, 0} + crank;
    const std::string name = std::to_string(i);
    const BodyId body = machines::add_body(scene, "crank" + name, 1, {.1, .1, .1}, .5 * (foot + head));
    machines::add_joint(scene, "foot" + name, JointType::revolute, ground, body, foot);
    machines::add_joint(scene, "head" + name, JointType::revolute, body, bar, head);
  }
  return scene;
}

// A door on two hinges; the second is displaced from the axis of the first by `off`.
scene::Scene door(double off) {
  scene::Scene scene = machines::empty();
  const Vec3d axis = normalized(Vec3d{.3, -.5, .8});
  const BodyId body = machines::add_body(scene, "door", 20, {2, 5, 3}, Vec3d{.5, .3, 0} + .5 * axis);
  machines::add_joint(scene, "lower", JointType::revolute, ground, body, {0, 0, 0}, axis);
  machines::add_joint(scene, "upper", JointType::revolute, ground, body, axis + Vec3d{off, 0, 0}, axis);
  return scene;
}

int freedoms(const scene::Scene& scene) {
  return machines::Run(scene, 1e-3).assembly.degrees_of_freedom;
}

TEST(Redundancy, IsFoundInExactAndInRoundedData) {
  for (const double off : {0., 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5}) {
    EXPECT_EQ(freedoms(three_cranks(off)), 1) << off;
    EXPECT_EQ(freedoms(door(off)), 1) << off;
  }
}

TEST(Redundancy, RefusesDataThatContradictEachOther) {
  for (const double off : {1e-3, 1e-2, 3e-2}) {
    try {
      freedoms(three_cranks(off));
      FAIL() << off << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::scene);
      EXPECT_THAT(error.what(), HasSubstr("contradict each other"));
      EXPECT_THAT(error.what(), HasSubstr("joint \"head"));
      EXPECT_THAT(error.hint(), HasSubstr("assembly_tolerance"));
    }
  }
}

// Two parallel bars and one across them hold a beam.
TEST(Redundancy, LeavesATrussAlone) {
  scene::Scene scene = three_cranks(0);
  const Vec3d foot{3.2, .3, 0};
  scene::Body& bar = scene.mbd->bodies.back();
  bar.pose.p_WB = .5 * (foot + Vec3d{2 + std::cos(1.), std::sin(1.), 0});
  for (scene::Joint& joint : scene.mbd->joints)
    if (joint.name == "foot2") joint.position = foot;
  EXPECT_EQ(freedoms(scene), 0);
}

// A02 is horizontal, so that its equations along x vanish; a lever is at its dead point.
TEST(Redundancy, IsNotWhatASingularPositionLooksLike) {
  scene::Scene flat = machines::ladder(2);
  const double c = std::cos(std::numbers::pi / 2), s = std::sin(std::numbers::pi / 2);
  for (scene::Body& body : flat.mbd->bodies)  // vertical rods fall to the right
    body.pose.p_WB =
        body.pose.p_WB.y < .75 ? Vec3d{body.pose.p_WB.x + .5 * s, 0, 0} : Vec3d{body.pose.p_WB.x + s, c, 0};
  for (scene::Joint& joint : flat.mbd->joints)
    if (joint.position.y > .5) joint.position = {joint.position.x + s, 0, 0};
  const machines::Run run(flat, 1e-3);
  MachineSystem system(run.model);
  EXPECT_THAT(find_redundancy(run.model, system, run.state, of_data).equations, testing::IsEmpty());
  machines::Run dead_point(machines::shipped("dead_point"), 1e-3);
  EXPECT_THAT(find_redundancy(dead_point.model, dead_point.system, dead_point.state, of_data).equations,
              testing::IsEmpty());
}

std::vector<Components> undetermined(machines::Run& run) {
  run.system.residual(run.state);
  return UndeterminedReactions(run.model).find(run.system, true);
}

TEST(UndeterminedReactions, AreThoseOfBothHinges) {
  machines::Run run(door(1e-7), 1e-3);
  EXPECT_THAT(undetermined(run), testing::ElementsAre(63u, 63u));
}

TEST(UndeterminedReactions, AreAcrossThePlaneOfALinkage) {
  machines::Run run(machines::ladder(1), 1e-3);
  const Components across = 1u << 2 | 1u << 3 | 1u << 4;  // force z, torque x, torque y
  for (const Components c : undetermined(run)) EXPECT_EQ(c, across);
  EXPECT_THAT(component_names(across),
              testing::ElementsAre(testing::StrEq("force.z"), testing::StrEq("torque.x"),
                                   testing::StrEq("torque.y")));
}

// The third crank's share of the load along the cranks is undetermined as well.
TEST(UndeterminedReactions, AreInThePlaneWhereALinkageHasACrankTooMany) {
  machines::Run run(three_cranks(0), 1e-3);
  for (const Components c : undetermined(run)) EXPECT_EQ(c & 3u, 3u);
}

TEST(UndeterminedReactions, AreNoneWithoutRedundantEquations) {
  machines::Run run(machines::shipped("heavy_top"), 1e-4);
  EXPECT_THAT(undetermined(run), testing::Each(0u));
}

// The distance of a body from the world's origin does not affect its motion.
TEST(Model, IsComputedNearItself) {
  machines::Run near(door(0), 1e-3);
  scene::Scene moved = door(0);
  const Vec3d far{1 << 20, -(1 << 20), 1 << 19};
  for (scene::Body& body : moved.mbd->bodies) body.pose.p_WB = body.pose.p_WB + far;
  for (scene::Joint& joint : moved.mbd->joints) joint.position = joint.position + far;
  machines::Run away(moved, 1e-3);
  near.advance(500), away.advance(500);
  EXPECT_LT((away.position(0) - to_eigen(far) - near.position(0)).norm(),
            1e-8);  // the digits of the file
}

}  // namespace
}  // namespace tandem::mbd
