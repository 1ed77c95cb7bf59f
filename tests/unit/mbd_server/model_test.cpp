// The tree built from a scene, its first state, and its refusals.
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "mbd_server/io/observation.hpp"
#include "mbd_server/setup/topology.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;

TEST(Model, ListsParentsBeforeChildren) {
  // The scene names the outermost body first.
  scene::Scene scene = machines::empty();
  const BodyId outer = machines::add_body(scene, "outer", 1, {1, 1, 1}, {2, 0, 0});
  const BodyId inner = machines::add_body(scene, "inner", 1, {1, 1, 1}, {1, 0, 0});
  machines::add_joint(scene, "second", JointType::revolute, inner, outer, {1.5, 0, 0});
  machines::add_joint(scene, "first", JointType::revolute, ground, inner, {.5, 0, 0});
  const Model model = build_model(scene);
  ASSERT_EQ(model.links.size(), 3u);
  EXPECT_EQ(model.links[1].parent, 0);
  EXPECT_EQ(model.links[2].parent, 1);
  EXPECT_EQ(model.bodies[outer.value].link, 2);
  EXPECT_EQ(model.freedoms, 2);
  EXPECT_EQ(model.coordinate_names[1], "joint \"second\" of body \"outer\"");
}

TEST(Model, CountsCoordinates) {
  const Model model = build_model(machines::menagerie());
  // rail 1, elbow 1, socket 3, twist 1, spindle 1, loose 6; the driven joint has none.
  EXPECT_EQ(model.freedoms, 13);
  EXPECT_EQ(model.coordinates, 15);
  EXPECT_EQ(model.welded, 1);
  EXPECT_TRUE(model.driven);
  EXPECT_TRUE(model.damped);
  EXPECT_EQ(model.boundary, (std::vector<int>{3, 5}));
  for (std::size_t i = 1; i < model.links.size(); ++i) EXPECT_LT(model.links[i].parent, static_cast<int>(i));
}

TEST(Model, StartsInThePoseAndTwistOfTheScene) {
  const scene::Scene scene = machines::menagerie();
  const Model model = build_model(scene);
  State state = initial_state(model, scene);
  scene::Scene still = scene;
  std::get<scene::HarmonicMotion>(*still.mbd->joints[4].motion) = {0, .6, 1.5, 0};  // zero at t = 0
  const Model at_zero = build_model(still);
  std::vector<LinkMotion> links;
  compute_kinematics(at_zero, state, links);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyMotionState seen = observe_body(at_zero, links, static_cast<int>(b));
    const scene::Body& given = scene.mbd->bodies[b];
    EXPECT_LT(norm(seen.pose.p_WB - given.pose.p_WB), 1e-15) << given.name;
    EXPECT_LT(norm(rotation_vector(seen.pose.q_WB.conjugate() * given.pose.q_WB)), 1e-15) << given.name;
  }
  const BodyMotionState loose = observe_body(at_zero, links, 5);
  EXPECT_LT(norm(loose.twist.v_WB - scene.mbd->bodies[5].twist.v_WB), 1e-15);
  EXPECT_LT(norm(loose.twist.w_WB - scene.mbd->bodies[5].twist.w_WB), 1e-15);
}

TEST(Model, BodiesWeldedToTheGroundCostNothing) {
  scene::Scene scene = machines::empty();
  const BodyId base = machines::add_body(scene, "base", 1, {1, 1, 1}, {1, 0, 0});
  const BodyId top = machines::add_body(scene, "top", 1, {1, 1, 1}, {1, 0, 1});
  machines::add_joint(scene, "bolt", JointType::fixed, ground, base, {1, 0, 0});
  machines::add_joint(scene, "glue", JointType::fixed, base, top, {1, 0, .5});
  const Model model = build_model(scene);
  EXPECT_EQ(model.freedoms, 0);
  EXPECT_EQ(model.links.size(), 1u);
  EXPECT_EQ(model.welded, 2);
}

// A body of two welded parts moves as the one equivalent body, and the parts are still reported.
TEST(Model, WeldedBodiesMoveAsOne) {
  scene::Scene parts = machines::empty();
  const BodyId a = machines::add_body(parts, "a", 2, {.1, .2, .3}, {1, 0, 0});
  const BodyId b = machines::add_body(parts, "b", 1, {.02, .03, .04}, {1.6, .3, 0});
  machines::add_joint(parts, "pin", JointType::spherical, ground, a, {0, 0, 0});
  machines::add_joint(parts, "weld", JointType::fixed, a, b, {1.3, 0, 0});

  // Centre at (1.2, .1, 0); d_a = (-.2, -.1, 0), d_b = (.4, .2, 0).
  scene::Scene whole = machines::empty();
  const BodyId c = machines::add_body(whole, "c", 3, {}, {1.2, .1, 0});
  const double m_a = 2, m_b = 1;
  whole.mbd->bodies[0].inertia = {.1 + .02 + m_a * .01 + m_b * .04,
                                  .2 + .03 + m_a * .04 + m_b * .16,
                                  .3 + .04 + m_a * .05 + m_b * .2,
                                  -m_a * .02 - m_b * .08,
                                  0,
                                  0};
  machines::add_joint(whole, "pin", JointType::spherical, ground, c, {0, 0, 0});

  machines::Run one(whole, 1e-3), two(parts, 1e-3);
  for (machines::Run* run : {&one, &two}) run->restart([](State& s) { s.u = Vector3d(.3, -2, 5); });
  one.advance(500);
  two.advance(500);
  EXPECT_LT((one.state.q - two.state.q).norm(), 1e-12);
  const Vector3d centre = (m_a * two.position(0) + m_b * two.position(1)) / 3;
  EXPECT_LT((one.position(0) - centre).norm(), 1e-12);
  EXPECT_NEAR((two.position(1) - two.position(0)).norm(), std::hypot(.6, .3), 1e-14);
}

std::string refusal(const scene::Scene& scene) {
  try {
    build_model(scene);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    return error.what();
  }
  return "accepted";
}

// A four-bar: the last joint closes the loop, whichever of its bodies is the parent in the file.
scene::Scene four_bar() {
  scene::Scene scene = machines::empty({0, -9.81, 0});
  const BodyId left = machines::add_body(scene, "left", 1, {.1, .1, .1}, {0, .5, 0});
  const BodyId bar = machines::add_body(scene, "bar", 1, {.1, .1, .1}, {.5, 1, 0});
  const BodyId right = machines::add_body(scene, "right", 1, {.1, .1, .1}, {1, .5, 0});
  machines::add_joint(scene, "A", JointType::revolute, ground, left, {0, 0, 0});
  machines::add_joint(scene, "B", JointType::revolute, left, bar, {0, 1, 0});
  machines::add_joint(scene, "C", JointType::revolute, bar, right, {1, 1, 0});
  machines::add_joint(scene, "D", JointType::revolute, ground, right, {1, 0, 0});
  return scene;
}

TEST(Topology, CutsALoopAtItsFarEnd) {
  const Topology t = find_topology(four_bar());
  EXPECT_EQ(t.cuts, (std::vector<int>{2}));
  EXPECT_EQ(t.edges[2].joint, 3);
  EXPECT_FALSE(t.edges[2].reversed);
}

TEST(Topology, CutsWhereTheSceneSaysSo) {
  scene::Scene scene = four_bar();
  scene.mbd->joints[3].cut = true;
  const Topology t = find_topology(scene);
  EXPECT_EQ(t.cuts, (std::vector<int>{3}));
  EXPECT_EQ(t.edges[2].inboard, 1);
}

TEST(Topology, KeepsJointsThatNeedTheirCoordinate) {
  scene::Scene scene = four_bar();
  scene.mbd->joints[1].damping = .1;
  scene.mbd->joints[2].rate = 1;
  scene.mbd->joints[0].motion = scene::ConstantMotion{};
  EXPECT_EQ(find_topology(scene).cuts, (std::vector<int>{3}));
}

TEST(Topology, TurnsAJointRound) {
  scene::Scene scene = four_bar();
  scene.mbd->joints[3].cut = true;
  std::swap(scene.mbd->joints[2].parent, scene.mbd->joints[2].child);
  const Topology t = find_topology(scene);
  EXPECT_TRUE(t.edges[2].reversed);
  const Model model = build_model(scene);
  EXPECT_EQ(model.joints[2].coordinate_link, model.bodies[2].link);
  EXPECT_LT((model.links[model.bodies[2].link].axis + Vector3d::UnitZ()).norm(), 1e-15);
}

TEST(Topology, FreesOneBodyOfARing) {
  scene::Scene ring = machines::empty();
  const BodyId a = machines::add_body(ring, "a", 1, {1, 1, 1}, {0, 0, 0});
  const BodyId b = machines::add_body(ring, "b", 1, {1, 1, 1}, {1, 0, 0});
  machines::add_joint(ring, "ab", JointType::revolute, a, b, {0, 0, 0});
  machines::add_joint(ring, "ba", JointType::revolute, b, a, {0, 0, 0});
  const Topology t = find_topology(ring);
  EXPECT_EQ(t.edges[0].joint, none);
  EXPECT_EQ(t.edges[1].joint, 0);
  EXPECT_EQ(t.cuts, (std::vector<int>{1}));
}

TEST(Topology, RefusesALoopOfDrivenJoints) {
  scene::Scene scene = four_bar();
  for (scene::Joint& joint : scene.mbd->joints) joint.damping = 1;
  EXPECT_EQ(
      refusal(scene),
      "mbd.joints[3]: joint \"D\" closes a loop of joints that all need their coordinate: each has a motion, "
      "rate, damping, spring, actuator, motor, drum of a rope or coupler (leave that out at one joint of the "
      "loop, which then can be cut)");
}

TEST(Model, RefusesARopeWithAPointOnItsDrum) {
  scene::Scene scene = four_bar();
  const scene::Joint& joint = scene.mbd->joints[0];
  scene::Rope rope{"hoist", {{joint.parent, {0, .1, 0}}, {joint.child, {1, 1, 0}}}, 1, 1e3, 0};
  rope.drum = JointId{0};
  scene.mbd->forces.push_back(rope);
  EXPECT_EQ(
      refusal(scene),
      "mbd.forces[0]: rope \"hoist\" has a point that turns with its drum (give points of bodies that are "
      "not fixed to the drum)");
}

TEST(Model, RefusesAMotionOfSeveralFreedoms) {
  scene::Scene driven = machines::heavy_top();
  driven.mbd->joints[0].motion = scene::ConstantMotion{};
  EXPECT_EQ(
      refusal(driven),
      "mbd.joints[0]: joint \"tip\" cannot be driven by a motion (only revolute and prismatic joints can)");
}

}  // namespace
}  // namespace tandem::mbd
