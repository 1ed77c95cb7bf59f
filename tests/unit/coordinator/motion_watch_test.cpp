// Contradictions of a multibody participant: windows that do not follow each other, and false frames.
#include "coordinator/watch/motion_watch.hpp"

#include <gtest/gtest.h>

namespace tandem::launch {
namespace {

// Two bodies with a radius of gyration of 0.5 m, the second one with walls; windows of 10 ms.
scene::Scene two_bodies() {
  scene::Scene scene;
  scene.coupling.window = 0.01;
  scene.mbd.emplace();
  for (const char* name : {"idle", "box"}) {
    scene::Body& body = scene.mbd->bodies.emplace_back();
    body.name = name;
    body.mass = 4;
    body.inertia = {1, 1, 1, 0, 0, 0};
  }
  return scene;
}

constexpr Nanoseconds window_length{10'000'000};

// A window in which body 1 moves along x with 1 m/s.
Exchange straight_window(std::int64_t index) {
  Exchange exchange;
  exchange.motion.window = {static_cast<std::uint64_t>(index), Nanoseconds{index * window_length.count},
                            Nanoseconds{(index + 1) * window_length.count}};
  protocol::BodyMotion& motion = exchange.motion.bodies.emplace_back();
  motion.body = 1;
  motion.begin_pose.p_WB.x = 0.01 * static_cast<double>(index);
  motion.end_pose.p_WB.x = 0.01 * static_cast<double>(index + 1);
  motion.begin_twist.v_WB = motion.end_twist.v_WB = {1, 0, 0};
  return exchange;
}

MotionWatch started_watch() {
  MotionWatch watch(two_bodies());
  Exchange first = straight_window(0);
  first.motion.bodies[0].end_pose = first.motion.bodies[0].begin_pose;
  watch.begin_with(first.motion.bodies);
  return watch;
}

TEST(MotionWatch, WindowsThatFollowEachOtherAreSilent) {
  MotionWatch watch = started_watch();
  for (int i = 0; i < 5; ++i) watch.record(straight_window(i).motion);
  EXPECT_TRUE(watch.jumps().empty());
}

TEST(MotionWatch, AJumpIsRelativeToTheSizeAndAddsUp) {
  MotionWatch watch = started_watch();
  for (int i = 0; i < 5; ++i) {
    Exchange exchange = straight_window(i);
    if (i == 2) exchange.motion.bodies[0].begin_pose.p_WB.z = 0.05;
    if (i == 3) exchange.motion.bodies[0].begin_pose.p_WB.z = -0.1;
    watch.record(exchange.motion);
  }
  ASSERT_EQ(watch.jumps().size(), 1u);
  const MotionWatch::Jumps& jumps = watch.jumps().at(1);
  EXPECT_DOUBLE_EQ(jumps.sum, 0.1 + 0.2);
  EXPECT_DOUBLE_EQ(jumps.largest.position, 0.1);
  EXPECT_DOUBLE_EQ(jumps.largest.time, 0.03);
}

TEST(MotionWatch, VelocitiesCountAsWhatTheyMoveInAWindow) {
  MotionWatch watch = started_watch();
  Exchange exchange = straight_window(0);
  exchange.motion.bodies[0].begin_twist.v_WB.z = 3;
  watch.record(exchange.motion);
  EXPECT_DOUBLE_EQ(watch.jumps().at(1).sum, 3 * 0.01 / 0.5);
  EXPECT_DOUBLE_EQ(watch.jumps().at(1).largest.speed, 3);
  exchange = straight_window(1);
  exchange.motion.bodies[0].begin_twist.w_WB.y = 4;
  watch.record(exchange.motion);
  EXPECT_DOUBLE_EQ(watch.jumps().at(1).sum, 0.06 + 4 * 0.01);
}

TEST(MotionWatch, TheFirstWindowFollowsTheConfiguredState) {
  MotionWatch watch = started_watch();
  Exchange exchange = straight_window(0);
  exchange.motion.bodies[0].begin_pose.p_WB.y = 0.5;
  watch.record(exchange.motion);
  EXPECT_DOUBLE_EQ(watch.jumps().at(1).sum, 1);
}

// q and -q are the same orientation.
TEST(MotionWatch, TheSignOfAQuaternionIsNoRotation) {
  MotionWatch watch = started_watch();
  Exchange exchange = straight_window(0);
  exchange.motion.bodies[0].begin_pose.q_WB = {-1, 0, 0, 0};
  watch.record(exchange.motion);
  EXPECT_NEAR(watch.jumps().at(1).sum, 0, 1e-15);
}

TEST(MotionWatch, FramesShowTheBodiesWhereTheyEnded) {
  MotionWatch watch = started_watch();
  watch.record(straight_window(0).motion);
  std::vector<protocol::BodyState> frame(2);
  frame[0].pose.p_WB = {7, 7, 7};  // without walls: its motion is not known here
  frame[1].body = 1;
  frame[1].pose.p_WB.x = 0.01;
  frame[1].twist.v_WB.x = 1;
  watch.observe(window_length, frame);
  EXPECT_TRUE(watch.false_frames().empty());
  frame[1].pose.p_WB.z = 0.25;
  watch.observe(window_length, frame);
  ASSERT_EQ(watch.false_frames().size(), 1u);
  EXPECT_DOUBLE_EQ(watch.false_frames().at(1).share, 0.5);
  EXPECT_DOUBLE_EQ(watch.false_frames().at(1).time, 0.01);
}

}  // namespace
}  // namespace tandem::launch
