// Pose of a body within a window. The host prepares a path once per window (with functions of libm). Every
// micro step then evaluates polynomials with + - * / only, so that every back end gets the same bits.
//
// Position: cubic Hermite in time, from position and velocity at both ends. Orientation: q(s) = exp(phi(s))
// q_begin, where the rotation vector phi (world axes) is a cubic Hermite in s = t / H:
//   phi(0) = 0, phi(1) = log(q_end q_begin^-1), phi' = H Jl(phi)^-1 w at both ends, and w = Jl(phi) phi' / H,
// with the left Jacobian Jl of SO(3) ([Chirikjian2012] eq. 10.86). Pose errors fall with H^4, velocity errors
// with H^3; velocities are the derivative of the path at every s.
#pragma once

#include <cstdint>

#include "common/math/rotation.hpp"

namespace tandem::particles {

struct PathSegment {
  Pose begin, end;
  Twist begin_twist, end_twist;
};

struct PreparedPath {
  PathSegment segment;
  double length = 0;          // H [s]
  Vec3d rotation_vector;      // phi(1) [rad]
  Vec3d rotation_rate_begin;  // phi'(0) [rad]
  Vec3d rotation_rate_end;    // phi'(1) [rad]
};

// Body B at one instant, world axes. The velocities of a window's micro steps (FillPoses) are those of half a
// step before, like those of the spheres in leapfrog.
struct BodyPose {
  Vec3d p;  // p_WB [m]
  Mat3d R;  // R_WB [-]
  Vec3d v;  // v_WB [m/s]
  Vec3d w;  // w_WB [rad/s]

  friend bool operator==(const BodyPose&, const BodyPose&) = default;
};

// Adds the velocity of a belt to that of its body, for the tangents of contacts, which need only the part
// across the normal.
inline void add_belt(BodyPose& pose, Vec3d velocity_in_body) {
  if (velocity_in_body != Vec3d{}) pose.v += pose.R * velocity_in_body;
}

// Limit of the rotation vector of a path; within it the polynomials below are exact to round-off.
inline constexpr double max_turn = 0.5;  // [rad]

// H > 0 [s]. Error{numerics} when the path rotates by more than `max_turn` or is not finite; `body` names it
// in the error.
PreparedPath prepare_path(const PathSegment& segment, double H, const char* body = "");

// exp of a rotation vector with |phi| <= max_turn: Taylor series in the half angle, remainder < 1e-16.
TANDEM_HD inline Quat small_exp(Vec3d phi) {
  const double x = norm2(phi) * 0.25;
  const double c =
      1 - x / 2 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56 * (1 - x / 90 * (1 - x / 132 * (1 - x / 182))))));
  const double s =
      0.5 * (1 - x / 6 * (1 - x / 20 * (1 - x / 42 * (1 - x / 72 * (1 - x / 110 * (1 - x / 156))))));
  return {c, s * phi.x, s * phi.y, s * phi.z};
}

// Jl(phi) v with Jl = I + (1 - cos)/t^2 [phi] + (t - sin)/t^3 [phi]^2, t = |phi| <= max_turn.
TANDEM_HD inline Vec3d left_jacobian_times(Vec3d phi, Vec3d v) {
  const double x = norm2(phi);
  const double b =
      0.5 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56 * (1 - x / 90 * (1 - x / 132 * (1 - x / 182))))));
  const double c = (1 - x / 20 * (1 - x / 42 * (1 - x / 72 * (1 - x / 110 * (1 - x / 156))))) / 6;
  const Vec3d first = cross(phi, v);
  return v + b * first + c * cross(phi, first);
}

// Weights of the end value, the begin rate and the end rate; _d: derivatives.
struct HermiteBasis {
  double value, begin, end, value_d, begin_d, end_d;

  TANDEM_HD explicit HermiteBasis(double s) {
    const double r = 1 - s;
    value = s * s * (3 - 2 * s), begin = s * r * r, end = -(s * s * r);
    value_d = 6 * s * r, begin_d = r * (1 - 3 * s), end_d = s * (3 * s - 2);
  }
};

// phi
TANDEM_HD inline Vec3d rotation_on_path(const PreparedPath& path, const HermiteBasis& at) {
  return at.value * path.rotation_vector + at.begin * path.rotation_rate_begin +
         at.end * path.rotation_rate_end;
}

// s = t / H. For s <= 0 the twist is extrapolated with the mean acceleration of the path.
TANDEM_HD inline Twist twist_on_path(const PreparedPath& path, double s) {
  const PathSegment& g = path.segment;
  const Vec3d &v = g.begin_twist.v_WB, &w = g.begin_twist.w_WB;
  if (s <= 0) return {v + s * (g.end_twist.v_WB - v), w + s * (g.end_twist.w_WB - w)};
  if (s >= 1) return g.end_twist;

  const HermiteBasis at(s);
  const Vec3d move = g.end.p_WB - g.begin.p_WB;
  const Vec3d phi_d = at.value_d * path.rotation_vector + at.begin_d * path.rotation_rate_begin +
                      at.end_d * path.rotation_rate_end;
  return {(at.value_d / path.length) * move + at.begin_d * v + at.end_d * g.end_twist.v_WB,
          (1.0 / path.length) * left_jacobian_times(rotation_on_path(path, at), phi_d)};
}

// s = t / H in [0, 1]. Both ends are the given poses and twists to the bit.
TANDEM_HD inline BodyPose pose_on_path(const PreparedPath& path, double s) {
  const PathSegment& g = path.segment;
  if (s <= 0) return {g.begin.p_WB, g.begin.q_WB.matrix(), g.begin_twist.v_WB, g.begin_twist.w_WB};
  if (s >= 1) return {g.end.p_WB, g.end.q_WB.matrix(), g.end_twist.v_WB, g.end_twist.w_WB};

  const HermiteBasis at(s);
  const Vec3d move = g.end.p_WB - g.begin.p_WB;
  const Vec3d p = g.begin.p_WB + (at.value * move +
                                  path.length * (at.begin * g.begin_twist.v_WB + at.end * g.end_twist.v_WB));
  const Quat q = small_exp(rotation_on_path(path, at)) * g.begin.q_WB;
  const Twist twist = twist_on_path(path, s);
  return {p, q.matrix(), twist.v_WB, twist.w_WB};
}

// Pose of every body at every micro step of a window. In a window with a single step the velocities are those
// of its begin: extrapolated velocities would make the load depend on the end of the same window, with a sign
// that opposes the motion.
struct FillPoses {
  const PreparedPath* path;
  BodyPose* pose;
  std::uint32_t bodies, steps;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const double step = i / bodies;
    const BodyPose now = pose_on_path(path[i % bodies], step / steps);
    const Twist before = twist_on_path(path[i % bodies], steps == 1 ? 0 : (step - 0.5) / steps);
    pose[i] = {now.p, now.R, before.v_WB, before.w_WB};
  }
};

}  // namespace tandem::particles
