// Joints that the poses of a frame violate, one type after the other, and joint coordinates that are not
// those of the poses.
#include "coordinator/watch/joint_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

// A body at (1, 0, 0) on another at the origin, 2 m apart from the ground's joint; the size is 2 m.
scene::Scene scene_with(const std::string& joint) {
  return scene::parse(
      R"({"tandem": "1.1", "name": "joint", "end_time": 1, "coupling": {"window": 0.1},
  "mbd": {"bodies": [{"name": "base", "mass": 1, "inertia": [0.01, 0.01, 0.01]},
                     {"name": "arm", "mass": 1, "inertia": [0.01, 0.01, 0.01], "position": [2, 0, 0],
                      "orientation": [0.6, 0, 0.8, 0]}],
          "joints": [{"name": "j", "parent": "base", "child": "arm", "position": [1, 0, 0], )" +
          joint + "}]}}",
      "test");
}

// The arm displaced, and rotated about the joint's point; both bodies then move as one.
protocol::BodiesFrame frame_of(Vec3d displacement, Vec3d rotation, double q = 0) {
  const Quat turn = exp(rotation), both = exp(Vec3d{0.3, -1, 0.4});
  const Vec3d joint{1, 0, 0};
  protocol::BodiesFrame frame;
  frame.time = Nanoseconds{500'000'000};
  Pose arm{joint + displacement + turn.rotate({1, 0, 0}), turn * Quat{0.6, 0, 0.8, 0}};
  frame.bodies.resize(2);
  frame.bodies[0].pose = {{5, 6, 7}, both};
  frame.bodies[1].body = 1;
  frame.bodies[1].pose = {Vec3d{5, 6, 7} + both.rotate(arm.p_WB), both * arm.q_WB};
  frame.joints.resize(1);
  frame.joints[0].q = q;
  return frame;
}

struct Seen {
  double share = 0;
  std::string text;
};
Seen seen(const std::string& joint, Vec3d displacement, Vec3d rotation, double q = 0) {
  JointWatch watch(scene_with(joint));
  watch.observe(frame_of(displacement, rotation, q));
  if (watch.violations().empty()) return {};
  const JointViolation& v = watch.violations().at(0);
  EXPECT_EQ(v.time, 0.5);
  return {v.share, v.text()};
}

struct TypeCase {
  const char* joint;
  Vec3d allowed, allowed_rotation;      // a relative movement that the joint lets happen
  double q;                             // and its coordinate
  std::vector<Vec3d> apart, rotations;  // displacements and rotations that violate it
};

const std::vector<TypeCase>& types() {
  constexpr double d = 0.02;
  static const std::vector<TypeCase> all = {
      {R"("type": "fixed")", {}, {}, 0, {{d, 0, 0}, {0, d, 0}, {0, 0, d}}, {{d, 0, 0}, {0, d, 0}, {0, 0, d}}},
      {R"("type": "revolute", "axis": [0, 0, 1])",
       {},
       {0, 0, 0.5},
       0.5,
       {{d, 0, 0}, {0, d, 0}, {0, 0, d}},
       {{d, 0, 0}, {0, d, 0}}},
      {R"("type": "prismatic", "axis": [0, 0, 1])",
       {0, 0, 0.5},
       {},
       0.5,
       {{d, 0, 0}, {0, d, 0}},
       {{d, 0, 0}, {0, d, 0}, {0, 0, d}}},
      {R"("type": "cylindrical", "axis": [0, 0, 1])",
       {0, 0, 0.5},
       {0, 0, 0.5},
       0,
       {{d, 0, 0}, {0, d, 0}},
       {{d, 0, 0}, {0, d, 0}}},
      {R"("type": "screw", "axis": [0, 0, 1], "pitch": 0.2)",
       {0, 0, 0.1},
       {0, 0, 0.5},
       0.5,
       {{d, 0, 0}, {0, d, 0}, {0, 0, d}},
       {{d, 0, 0}, {0, d, 0}}},
      {R"("type": "spherical")", {}, {0.3, -0.4, 0.5}, 0, {{d, 0, 0}, {0, d, 0}, {0, 0, d}}, {}},
      {R"("type": "planar", "axis": [0, 0, 1])",
       {0.3, -0.2, 0},
       {0, 0, 0.5},
       0,
       {{0, 0, d}},
       {{d, 0, 0}, {0, d, 0}}},
      {R"("type": "universal", "axis": [0, 0, 1], "axis2": [1, 0, 0])",
       {},
       {0, 0, 0.5},
       0,
       {{d, 0, 0}, {0, d, 0}, {0, 0, d}},
       {{0, d, 0}}},
      {R"("type": "free")", {1, 2, 3}, {0.3, -0.4, 0.5}, 0, {}, {}},
  };
  return all;
}

TEST(JointWatch, EachTypeLetsMoveWhatItShouldAndNothingElse) {
  for (const TypeCase& c : types()) {
    SCOPED_TRACE(c.joint);
    EXPECT_EQ(seen(c.joint, {}, {}).text, "");
    EXPECT_EQ(seen(c.joint, c.allowed, c.allowed_rotation, c.q).text, "");
    for (const Vec3d& d : c.apart) {
      const Seen s = seen(c.joint, d, {});
      EXPECT_NEAR(s.share, 0.01, 1e-3) << d.x << d.y << d.z;
      EXPECT_EQ(s.text, "its two sides are 0.02 m apart");
    }
    for (const Vec3d& r : c.rotations) {
      const Seen s = seen(c.joint, {}, r);
      EXPECT_NEAR(s.share, 0.02, 1e-6) << r.x << r.y << r.z;
      EXPECT_EQ(s.text, "its two sides are rotated against each other by 0.02 rad");
    }
  }
}

TEST(JointWatch, ADistanceIsKept) {
  const std::string joint = R"("type": "distance", "child_position": [1, 0, 0.5], "length": 0.5)";
  EXPECT_EQ(seen(joint, {}, {}).text, "");
  EXPECT_EQ(seen(joint, {0, 0, 0.01}, {}).text, "its two sides are 0.01 m apart");
}

TEST(JointWatch, CoordinatesAreThoseOfThePoses) {
  const std::string hinge = R"("type": "revolute", "axis": [0, 0, 1])",
                    slide = R"("type": "prismatic", "axis": [0, 0, 1])";
  EXPECT_EQ(seen(hinge, {}, {0, 0, 0.5}, 0.4).text,
            "the coordinate that the frame gives for it is 0.1 rad off that of the bodies");
  EXPECT_EQ(seen(slide, {0, 0, 0.5}, {}, 0.4).text,
            "the coordinate that the frame gives for it is 0.1 m off that of the bodies");
  EXPECT_EQ(seen(hinge, {}, {0, 0, 0.5}, 0.5 - 8 * std::acos(-1)).text, "") << "angles count turns";
}

TEST(JointWatch, PrescribedCoordinatesFollowTheirMotion) {
  const std::string hinge =
      R"("type": "revolute", "axis": [0, 0, 1], "motion": {"type": "constant", "value": 0.1, "rate": 1})";
  EXPECT_EQ(seen(hinge, {}, {0, 0, 0.6}, 0.6).text, "");
  EXPECT_EQ(seen(hinge, {}, {0, 0, 0.5}, 0.5).text, "its coordinate is 0.1 rad off its prescribed motion");
}

TEST(JointWatch, TheLargestViolationIsKept) {
  JointWatch watch(scene_with(R"("type": "fixed")"));
  for (const double d : {0.1, 0.4, 0.2}) watch.observe(frame_of({d, 0, 0}, {}));
  EXPECT_NEAR(watch.violations().at(0).open, 0.4, 1e-12);
}

}  // namespace
}  // namespace tandem::launch
