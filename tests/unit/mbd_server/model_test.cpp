// The tree that is built from a scene, its first state, and what it refuses.
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "mbd_server/io/observation.hpp"
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

// A body made of two welded parts moves as the one body that they make, and the parts are still reported.
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

TEST(Model, RefusesWhatIsNoTree) {
  scene::Scene scene = machines::pendulum();
  machines::add_joint(scene, "again", JointType::revolute, ground, BodyId{0}, {1, 0, 0});
  EXPECT_EQ(refusal(scene),
            "mbd.joints[1]: joint \"again\" closes a loop: body \"mass\" already hangs on joint \"pin\" "
            "(each body can be "
            "the child of one joint; closed loops are not supported yet)");

  scene::Scene ring = machines::empty();
  const BodyId a = machines::add_body(ring, "a", 1, {1, 1, 1}, {0, 0, 0});
  const BodyId b = machines::add_body(ring, "b", 1, {1, 1, 1}, {1, 0, 0});
  machines::add_joint(ring, "ab", JointType::revolute, a, b, {0, 0, 0});
  machines::add_joint(ring, "ba", JointType::revolute, b, a, {0, 0, 0});
  EXPECT_EQ(refusal(ring),
            "mbd.joints[1]: joint \"ba\" is part of a ring of joints that never reaches the ground (hang one "
            "body of the "
            "ring on the ground, or leave its joint out to make it free)");

  scene::Scene driven = machines::heavy_top();
  driven.mbd->joints[0].motion = scene::ConstantMotion{};
  EXPECT_EQ(
      refusal(driven),
      "mbd.joints[0]: joint \"tip\" cannot be driven by a motion (only revolute and prismatic joints can)");
}

}  // namespace
}  // namespace tandem::mbd
