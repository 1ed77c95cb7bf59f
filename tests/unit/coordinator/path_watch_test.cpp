// Poses that do not follow from the velocities, and motions of methods of low order that do.
#include "coordinator/watch/path_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace tandem::launch {
namespace {

constexpr double path_H = 0.01;

struct Moving {
  Pose pose;
  Twist twist;
};
// Runs windows with the states at their ends; returns the shares of position and orientation.
struct Shares {
  double position = 0, orientation = 0;
};
Shares shares(int windows, const std::function<Moving(int)>& at) {
  scene::Scene scene;
  scene.mbd.emplace();
  scene::Body& body = scene.mbd->bodies.emplace_back();
  body.mass = 4;
  body.inertia = {1, 1, 1, 0, 0, 0};
  PathWatch watch(scene);
  for (std::int64_t i = 0; i < windows; ++i) {
    Exchange exchange;
    exchange.motion.window = {static_cast<std::uint64_t>(i), Nanoseconds{i * 10'000'000},
                              Nanoseconds{(i + 1) * 10'000'000}};
    protocol::BodyMotion& motion = exchange.motion.bodies.emplace_back();
    const Moving begin = at(static_cast<int>(i)), end = at(static_cast<int>(i) + 1);
    motion.begin_pose = begin.pose, motion.begin_twist = begin.twist;
    motion.end_pose = end.pose, motion.end_twist = end.twist;
    watch.record(exchange);
  }
  const PathWatch::Of& of = watch.bodies().at(0);
  return {of.displacement.share, of.rotation.share};
}

Moving falling(double share, int window) {
  const double t = path_H * window;
  Moving m;
  m.pose.p_WB = {0, 0, -0.5 * share * 9.81 * t * t};
  m.twist.v_WB = {0, 0, -9.81 * t};
  return m;
}
Moving spinning(double rate, double share, int window) {
  Moving m;
  m.pose.q_WB = exp(Vec3d{0, share * rate * path_H * window, 0});
  m.twist.w_WB = {0, rate, 0};
  return m;
}

TEST(PathWatch, ExactMotionsAreSilent) {
  for (const int windows : {1, 3, 100, 3000}) {
    EXPECT_EQ(shares(windows, [](int i) { return falling(1, i); }).position, 0) << windows;
    for (const double rate : {0.5, 30.0, 250.0, 700.0})
      EXPECT_LT(shares(windows, [rate](int i) { return spinning(rate, 1, i); }).orientation, 1e-12) << rate;
  }
}

TEST(PathWatch, PosesThatLagBehindAreSeen) {
  EXPECT_NEAR(shares(100, [](int i) { return falling(0.5, i); }).position, 0.5, 0.1);
  EXPECT_NEAR(shares(100, [](int i) { return falling(0, i); }).position, 1, 0.1);
  EXPECT_NEAR(shares(100, [](int i) { return spinning(3, 0, i); }).orientation, 1, 0.1);
  EXPECT_NEAR(shares(100, [](int i) { return spinning(3, 0.5, i); }).orientation, 0.5, 0.1);
}

// The mass of a long vibration has no way; a fault of its poses is seen in the first half of a period.
TEST(PathWatch, AVibrationIsJudgedByItsAmplitude) {
  const auto vibrating = [](double share) {
    return [share](int i) {
      const double phase = 0.05 * i;
      Moving m;
      m.pose.p_WB.x = share * std::sin(phase);
      m.twist.v_WB.x = 0.05 / path_H * std::cos(phase);
      return m;
    };
  };
  EXPECT_LT(shares(20'000, vibrating(1)).position, 1e-3);
  EXPECT_GT(shares(20'000, vibrating(0.8)).position, 0.05);
}

// Semi-implicit Euler of a pendulum with large swings: positions take the velocity of the end of the window.
TEST(PathWatch, AMethodOfFirstOrderIsSilent) {
  std::vector<Moving> states;
  double angle = 2.5, rate = 0;
  for (int i = 0; i <= 5000; ++i) {
    Moving m;
    m.pose = {{std::sin(angle), 0, -std::cos(angle)}, exp(Vec3d{0, -angle, 0})};
    m.twist = {{rate * std::cos(angle), 0, rate * std::sin(angle)}, {0, -rate, 0}};
    states.push_back(m);
    rate -= path_H * 9.81 * std::sin(angle);
    angle += path_H * rate;
  }
  const Shares s = shares(5000, [&](int i) { return states[static_cast<std::size_t>(i)]; });
  EXPECT_LT(s.position, 0.005);
  EXPECT_LT(s.orientation, 0.005);
}

// A torque-free body that tumbles by half a radian in each window, with the midpoint rule: the axis moves.
TEST(PathWatch, ATumblingBodyIsSilent) {
  std::vector<Moving> states;
  const Vec3d inertia{1, 2, 3}, momentum{20, 60, 90};
  Quat q;
  const auto spin = [&](const Quat& at) {
    const Vec3d l = at.conjugate().rotate(momentum);
    return at.rotate({l.x / inertia.x, l.y / inertia.y, l.z / inertia.z});
  };
  for (int i = 0; i <= 2000; ++i) {
    Moving m;
    m.pose.q_WB = q;
    m.twist.w_WB = spin(q);
    states.push_back(m);
    q = (exp(path_H * spin(exp(0.5 * path_H * spin(q)) * q)) * q).normalized();
  }
  EXPECT_LT(shares(2000, [&](int i) { return states[static_cast<std::size_t>(i)]; }).orientation, 0.005);
}

// A body that rebounds inside a window.
TEST(PathWatch, ImpactsAreSilent) {
  const auto bouncing = [](int i) {
    const double t = path_H * i, period = 0.317, phase = std::fmod(t, period) / period;
    Moving m;
    m.pose.p_WB.z = phase < 0.5 ? phase : 1 - phase;
    m.twist.v_WB.z = (phase < 0.5 ? 1 : -1) / period;
    return m;
  };
  EXPECT_LT(shares(3000, bouncing).position, 0.005);
}

TEST(PathWatch, BodiesAtRestAreSilentWithStatesInSinglePrecision) {
  const auto resting = [](int i) {
    Moving m;
    m.pose.p_WB = {1000 + (i % 3) * 6e-5, 0, 0};
    m.pose.q_WB = exp(Vec3d{(i % 5) * 6e-8, 0, 0});
    return m;
  };
  EXPECT_LT(shares(1000, resting).position, 0.01);
  EXPECT_LT(shares(1000, resting).orientation, 0.01);
}

}  // namespace
}  // namespace tandem::launch
