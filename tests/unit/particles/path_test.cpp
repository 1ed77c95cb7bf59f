#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

#include "common/error.hpp"
#include "particles/geometry/path.hpp"

namespace tandem::particles {
namespace {

Mat3d rotation_between(const Mat3d& a, const Mat3d& b) {  // b a^T
  Mat3d m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m.row[i][j] = dot(b.row[i], a.row[j]);
  }
  return m;
}

double distance(const Mat3d& a, const Mat3d& b) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) worst = std::max(worst, norm(a.row[i] - b.row[i]));
  return worst;
}

void expect_same(const BodyPose& a, const BodyPose& b) {
  EXPECT_EQ(a.p, b.p);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.w, b.w);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(a.R.row[i], b.R.row[i]);
}

const PathSegment general{{{0.1, 2, -3}, exp({0.3, -2, 0.4})},
                          {{0.1003, 2.001, -2.999}, exp({0.05, 0.2, -0.1}) * exp({0.3, -2, 0.4})},
                          {{0.2, 1.1, 0.8}, {40, 230, -80}},
                          {{0.4, 0.9, 1.2}, {60, 180, -130}}};

TEST(SmallExp, IsExactToRoundOff) {
  const Vec3d axis = normalized(Vec3d{0.3, -0.8, 0.5});
  for (double angle = 0; angle <= max_turn; angle += 0.01) {
    const Quat q = small_exp(angle * axis);
    EXPECT_NEAR(q.w, std::cos(angle / 2), 2.3e-16);
    EXPECT_NEAR(norm(Vec3d{q.x, q.y, q.z} - std::sin(angle / 2) * axis), 0, 2.3e-16);
    EXPECT_NEAR(q.norm2(), 1, 5e-16);
  }
}

TEST(Path, MeetsPosesAndTwistsAtBothEnds) {
  const double H = 1e-3;
  const PreparedPath path = prepare_path(general, H);
  for (const double s : {0.0, 1.0}) {
    const BodyPose at = pose_on_path(path, s);
    const Pose& pose = s == 0 ? path.segment.begin : path.segment.end;
    const Twist& twist = s == 0 ? general.begin_twist : general.end_twist;
    expect_same(at, {pose.p_WB, pose.q_WB.matrix(), twist.v_WB, twist.w_WB});
  }
  // The polynomials themselves reach the end, too, not only the branch for the ends.
  for (const double s : {1e-12, 1 - 1e-12}) {
    const BodyPose at = pose_on_path(path, s), end = pose_on_path(path, std::round(s));
    EXPECT_LT(norm(at.p - end.p), 2e-15);
    EXPECT_LT(distance(at.R, end.R), 2e-12);
    EXPECT_LT(norm(at.v - end.v), 1e-10);
    EXPECT_LT(norm(at.w - end.w), 1e-8);
  }
}

TEST(Path, ConstantTwistIsAScrewMotion) {
  const double H = 2e-3;
  const Vec3d v{3, -2, 0.5}, w{40, -90, 100};
  const Quat q0 = exp({1, 0.2, -0.4});
  const PathSegment segment{{{1, 2, 3}, q0}, {Vec3d{1, 2, 3} + H * v, exp(H * w) * q0}, {v, w}, {v, w}};
  const PreparedPath path = prepare_path(segment, H);
  double worst = 0;
  for (double s = 0; s <= 1; s += 1.0 / 64) {
    const BodyPose at = pose_on_path(path, s);
    worst = std::max({worst, norm(at.p - (Vec3d{1, 2, 3} + s * H * v)),
                      distance(at.R, (exp(s * H * w) * q0).matrix()), norm(at.v - v) / norm(v),
                      norm(at.w - w) / norm(w)});
  }
  std::cout << "largest deviation " << worst << ", tolerance 1e-12\n";
  EXPECT_LT(worst, 1e-12);
}

TEST(Path, RestIsTheSameBitsAllAlong) {
  const Pose pose{{0.1, -0.7, 1e3}, exp({0.3, -2, 0.4})};
  const PreparedPath path = prepare_path({pose, pose, {}, {}}, 1e-3);
  const BodyPose first = pose_on_path(path, 0);
  for (double s = 0; s <= 1; s += 1.0 / 97) expect_same(pose_on_path(path, s), first);
}

TEST(Path, VelocitiesAreTheDerivative) {
  const double H = 1e-3, h = 1e-5;
  const PreparedPath path = prepare_path(general, H);
  for (double s = 0.1; s < 0.95; s += 0.1) {
    const BodyPose at = pose_on_path(path, s), before = pose_on_path(path, s - h),
                   after = pose_on_path(path, s + h);
    EXPECT_LT(norm((after.p - before.p) * (1 / (2 * h * H)) - at.v), 1e-5);
    const Mat3d rotation = rotation_between(before.R, after.R);
    const Vec3d w = (1 / (4 * h * H)) * Vec3d{rotation.row[2].y - rotation.row[1].z,
                                              rotation.row[0].z - rotation.row[2].x,
                                              rotation.row[1].x - rotation.row[0].y};
    EXPECT_LT(norm(w - at.w) / norm(at.w), 1e-6);
  }
}

// Velocities half a step before, like those of the spheres in leapfrog; before the first step by the mean
// acceleration of the window.
TEST(Path, MicroStepsHaveTheVelocitiesOfHalfAStepBefore) {
  const double H = 1e-3;
  const PreparedPath path = prepare_path(general, H);
  constexpr std::uint32_t steps = 8;
  BodyPose pose[steps];
  for (std::uint32_t s = 0; s < steps; ++s) FillPoses{&path, pose, 1, steps}(s);
  for (std::uint32_t s = 0; s < steps; ++s) {
    const BodyPose at = pose_on_path(path, s * 1.0 / steps);
    EXPECT_EQ(pose[s].p, at.p);
    EXPECT_EQ(pose[s].R, at.R);
    if (s == 0) continue;
    const BodyPose before = pose_on_path(path, (s - 0.5) / steps);
    EXPECT_EQ(pose[s].v, before.v);
    EXPECT_EQ(pose[s].w, before.w);
  }
  const Twist &begin = general.begin_twist, &end = general.end_twist;
  EXPECT_LT(norm(pose[0].v - (begin.v_WB - 0.0625 * (end.v_WB - begin.v_WB))), 1e-15);
  EXPECT_LT(norm(pose[0].w - (begin.w_WB - 0.0625 * (end.w_WB - begin.w_WB))), 1e-12);
  FillPoses{&path, pose, 1, 1}(0);
  EXPECT_EQ(pose[0].v, begin.v_WB);
  EXPECT_EQ(pose[0].w, begin.w_WB);
}

TEST(Path, MatricesAreRotations) {
  const PreparedPath path = prepare_path(general, 1e-3);
  for (double s = 0; s <= 1; s += 0.01) {
    const Mat3d R = pose_on_path(path, s).R;
    EXPECT_LT(distance(rotation_between(R, R), Mat3d::identity()), 2e-15);
  }
}

// A motion that rotates about a moving axis while its origin oscillates.
BodyPose swinging(double t, Quat* q = nullptr) {
  const Vec3d a{0, 0, 1}, b = normalized(Vec3d{1, 0.5, 0});
  const double fa = std::sin(3 * t), fa_d = 3 * std::cos(3 * t), fb = std::cos(2 * t),
               fb_d = -2 * std::sin(2 * t);
  const Quat qa = exp(fa * a), product = qa * exp(fb * b);
  if (q) *q = product;
  return {{std::cos(4 * t), std::sin(4 * t), 0.3 * std::sin(t)},
          product.matrix(),
          {-4 * std::sin(4 * t), 4 * std::cos(4 * t), 0.3 * std::cos(t)},
          fa_d * a + fb_d * qa.rotate(b)};
}

TEST(Path, ConvergesWithTheFourthAndThirdPowerOfTheWindow) {
  double last_pose = 0, last_rate = 0;
  for (double H = 0.08; H > 0.004; H /= 2) {
    double pose_error = 0, rate_error = 0;
    for (double t = 0; t < 1; t += 0.16) {
      PathSegment g;
      const BodyPose begin = swinging(t, &g.begin.q_WB), end = swinging(t + H, &g.end.q_WB);
      g.begin.p_WB = begin.p;
      g.end.p_WB = end.p;
      g.begin_twist = {begin.v, begin.w};
      g.end_twist = {end.v, end.w};
      const PreparedPath path = prepare_path(g, H);
      for (double s = 0; s <= 1; s += 0.125) {
        const BodyPose at = pose_on_path(path, s), exact = swinging(t + s * H);
        pose_error = std::max({pose_error, norm(at.p - exact.p), distance(at.R, exact.R)});
        rate_error = std::max({rate_error, norm(at.v - exact.v), norm(at.w - exact.w)});
      }
    }
    if (last_pose > 0) {
      const double pose_order = std::log2(last_pose / pose_error),
                   rate_order = std::log2(last_rate / rate_error);
      std::cout << "H " << H << " pose error " << pose_error << " order " << pose_order << ", velocity error "
                << rate_error << " order " << rate_order << "\n";
      EXPECT_NEAR(pose_order, 4, 0.25);
      EXPECT_NEAR(rate_order, 3, 0.25);
    }
    last_pose = pose_error;
    last_rate = rate_error;
  }
}

TEST(Path, RefusesATurnThatTheSeriesDoNotCover) {
  const Quat q = exp({0, 0, 0.6});
  const auto refused = [](const PathSegment& segment) {
    try {
      prepare_path(segment, 1e-2, "wheel");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::numerics);
      EXPECT_EQ(e.where(), "body 'wheel'");
      return e.problem() + " | " + e.hint();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused({{{}, {}}, {{}, q}, {{}, {0, 0, 60}}, {{}, {0, 0, 60}}}),
            "the body turns by 0.6 rad in a window of 0.01 s; the limit is 0.5 rad | set coupling.window to "
            "0.007 s or "
            "less");
  EXPECT_NE(refused({{{}, {}}, {{}, {}}, {{}, {0, 400, 0}}, {}}), "accepted");
  EXPECT_NE(refused({{{}, {}}, {{}, {}}, {{}, {0, std::nan(""), 0}}, {}}), "accepted");
  EXPECT_NE(refused({{{0, 0, INFINITY}, {}}, {{}, {}}, {}, {}}), "accepted");
  EXPECT_NE(refused({{{}, {2, 0, 0, 0}}, {{}, {}}, {}, {}}), "accepted");
  const Quat small = exp({0, 0, 0.49});
  EXPECT_EQ(refused({{{}, {}}, {{}, small}, {{}, {0, 0, 49}}, {{}, {0, 0, 49}}}), "accepted");
}

}  // namespace
}  // namespace tandem::particles
