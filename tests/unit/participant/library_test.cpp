// The functions of the kit that need no solver, through the shared library.
#include <gtest/gtest.h>
#include <tandem/participant.h>

#include <cmath>

namespace {

// A body that accelerates along x from rest and rotates about z, over one window.
tandem_body_motion moving(double seconds, double acceleration, double rate) {
  tandem_body_motion motion{};
  motion.begin_pose.quaternion[0] = 1;
  motion.end_pose.position[0] = 0.5 * acceleration * seconds * seconds;
  motion.end_pose.quaternion[0] = std::cos(0.5 * rate * seconds);
  motion.end_pose.quaternion[3] = std::sin(0.5 * rate * seconds);
  motion.end_twist.velocity[0] = acceleration * seconds;
  motion.begin_twist.angular_velocity[2] = motion.end_twist.angular_velocity[2] = rate;
  return motion;
}

TEST(ParticipantLibrary, PoseInsideAWindowIsThatOfACubic) {
  const tandem_window window{3, 1'000'000, 3'000'000};
  const tandem_body_motion motion = moving(2e-3, 40, 100);
  for (const double t : {0.0, 0.3e-3, 1e-3, 2e-3}) {
    tandem_pose pose;
    tandem_twist twist;
    ASSERT_EQ(tandem_pose_at(&motion, &window, t, &pose, &twist), TANDEM_OK);
    EXPECT_NEAR(pose.position[0], 20 * t * t, 1e-15);
    EXPECT_NEAR(twist.velocity[0], 40 * t, 1e-12);
    EXPECT_NEAR(pose.quaternion[3], std::sin(50 * t), 1e-14);
    EXPECT_NEAR(twist.angular_velocity[2], 100, 1e-10);
  }
}

TEST(ParticipantLibrary, TheLastOfEqualStepsIsInsideTheWindow) {
  const tandem_window window{0, 0, 1'000'000};
  const tandem_body_motion motion = moving(1e-3, 1, 1);
  int beyond = 0;  // by round-off
  for (int steps = 1; steps < 1000; ++steps) {
    const double end = steps * (1e-3 / steps);
    beyond += end > 1e-3;
    tandem_pose pose;
    ASSERT_EQ(tandem_pose_at(&motion, &window, end, &pose, nullptr), TANDEM_OK) << steps;
    EXPECT_EQ(pose.position[0], motion.end_pose.position[0]);
  }
  EXPECT_GT(beyond, 0);
}

TEST(ParticipantLibrary, PoseOutsideAWindowIsRefused) {
  const tandem_window window{0, 0, 1'000'000};
  tandem_pose pose;
  tandem_body_motion motion = moving(1e-3, 1, 1);
  for (const double t : {-1e-9, 1.001e-3, std::nan("")})
    EXPECT_EQ(tandem_pose_at(&motion, &window, t, &pose, nullptr), TANDEM_ERROR_INTERNAL) << t;
  motion = moving(1e-3, 1, 600);
  EXPECT_EQ(tandem_pose_at(&motion, &window, 1e-4, &pose, nullptr), TANDEM_ERROR_NUMERICS);
}

TEST(ParticipantLibrary, HasAVersion) {
  EXPECT_STREQ(tandem_participant_version(), TANDEM_VERSION);
}

}  // namespace
