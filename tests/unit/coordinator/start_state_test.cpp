// A multibody participant that starts elsewhere than the scene says is refused with body, value and expected
// value.
#include "coordinator/start/start_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

using ::testing::HasSubstr;

// A free plate with a wall, and a pendulum of two links.
scene::Scene plate_and_pendulum() {
  scene::Scene scene;
  scene.mbd.emplace();
  for (const char* name : {"plate", "upper", "lower"}) {
    scene::Body& body = scene.mbd->bodies.emplace_back();
    body.name = name;
    body.mass = 1;
    body.inertia = {0.01, 0.01, 0.01, 0, 0, 0};
  }
  scene.mbd->bodies[0].pose.p_WB = {0, 0, 1};
  scene.mbd->bodies[0].twist = {{0, 0, -2}, {1, 0, 0}};
  for (const std::uint32_t child : {1u, 2u}) {
    scene::Joint& joint = scene.mbd->joints.emplace_back();
    joint.type = scene::JointType::revolute;
    joint.parent = child == 1 ? ground : BodyId{1};
    joint.child = BodyId{child};
  }
  scene.dem.emplace();
  scene.dem->walls.emplace_back().body = BodyId{0};
  return scene;
}

std::vector<protocol::BodyState> frame_of(const scene::Scene& scene) {
  std::vector<protocol::BodyState> frame;
  for (std::uint32_t b = 0; b < scene.mbd->bodies.size(); ++b)
    frame.push_back({b, 0, scene.mbd->bodies[b].pose, scene.mbd->bodies[b].twist});
  return frame;
}

template <class Bodies>
std::string refusal_to_start(const scene::Scene& scene, const Bodies& bodies) {
  try {
    StartOfBodies(scene).expect(bodies);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol);
    return error.problem();
  }
  return "none";
}

TEST(StartState, ThatOfTheSceneIsTaken) {
  const scene::Scene scene = plate_and_pendulum();
  auto frame = frame_of(scene);
  frame[1].twist.w_WB.x = 3;  // follows from its joint
  EXPECT_EQ(refusal_to_start(scene, frame), "none");
}

TEST(StartState, AnotherOneIsRefusedByBodyAndValue) {
  const scene::Scene scene = plate_and_pendulum();
  auto frame = frame_of(scene);
  frame[0].pose.p_WB.z += 0.001;
  EXPECT_EQ(refusal_to_start(scene, frame),
            "body 'plate' starts with the position (0, 0, 1.001) m, and the scene gives it (0, 0, 1) m");
  frame = frame_of(scene);
  frame[0].pose.q_WB = exp({0, 0, 0.1});
  EXPECT_THAT(refusal_to_start(scene, frame), HasSubstr("body 'plate' starts with the orientation (0.99875"));
  frame = frame_of(scene);
  frame[0].twist.v_WB = {};
  EXPECT_THAT(refusal_to_start(scene, frame),
              HasSubstr("velocity (0, 0, 0) m/s, and the scene gives it (0, 0, -2)"));
  frame = frame_of(scene);
  frame[0].twist.w_WB.x = 1.001;
  EXPECT_THAT(refusal_to_start(scene, frame), HasSubstr("angular velocity (1.001, 0, 0) rad/s"));
  frame = frame_of(scene);
  frame[2].pose.p_WB.x = 0.1;
  EXPECT_THAT(refusal_to_start(scene, frame), HasSubstr("body 'lower' starts with the position"))
      << "joints of a tree";
}

TEST(StartState, WhatPrescribedMotionsAndLoopsMoveIsNotJudged) {
  scene::Scene moved = plate_and_pendulum();
  moved.mbd->joints[0].motion = scene::ConstantMotion{0.5, 0};
  scene::Scene loop = plate_and_pendulum();
  scene::Joint& closing = loop.mbd->joints.emplace_back();
  closing.type = scene::JointType::revolute;
  closing.child = BodyId{2};
  for (const scene::Scene& scene : {moved, loop}) {
    auto frame = frame_of(scene);
    frame[2].pose.p_WB.x = 0.1;
    EXPECT_EQ(refusal_to_start(scene, frame), "none");
    frame[0].pose.p_WB.x = 0.1;
    EXPECT_THAT(refusal_to_start(scene, frame), HasSubstr("body 'plate'")) << "it has no joint";
  }
}

TEST(StartState, AnEquilibriumIsNotJudged) {
  scene::Scene scene = plate_and_pendulum();
  scene.mbd->start = scene::Start::equilibrium;
  auto frame = frame_of(scene);
  frame[0].pose.p_WB.x = 0.1;
  frame[0].twist = {};
  frame[2].pose.p_WB.x = 0.1;
  EXPECT_EQ(refusal_to_start(scene, frame), "none");
}

TEST(StartState, TheBodiesWithWallsAreThoseOfTheScene) {
  const scene::Scene scene = plate_and_pendulum();
  protocol::BodyMotion motion;
  motion.begin_pose = motion.end_pose = scene.mbd->bodies[0].pose;
  motion.begin_twist = motion.end_twist = scene.mbd->bodies[0].twist;
  std::vector<protocol::BodyMotion> boundary{motion};
  EXPECT_EQ(refusal_to_start(scene, boundary), "none");
  boundary[0].end_pose.p_WB.y = 2;
  EXPECT_THAT(refusal_to_start(scene, boundary), HasSubstr("position (0, 2, 1) m"));
  boundary[0] = motion;
  boundary[0].body = 1;
  EXPECT_EQ(refusal_to_start(scene, boundary),
            "the answer to configure has the motion of body 1, which has no walls");
  EXPECT_EQ(refusal_to_start(scene, std::vector<protocol::BodyMotion>{}),
            "the answer to configure lacks the motion of body 'plate', which has walls");
}

}  // namespace
}  // namespace tandem::launch
