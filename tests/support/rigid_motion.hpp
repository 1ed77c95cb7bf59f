// A multibody scene in another frame, and a scene whose data are decimals of few digits.
#pragma once

#include <random>

#include "common/scene/model.hpp"

namespace tandem::test {

// p -> R (p - from) + to, with the rotation as a quaternion and as a matrix. A point at `from` moves to `to`
// exactly.
struct RigidMotion {
  Quat q;
  Mat3d R = Mat3d::identity();
  Vec3d from, to;

  explicit RigidMotion(Quat rotation, Vec3d from = {}, Vec3d to = {});
  // The same with a matrix of zeros and ones, for rotations by multiples of a quarter turn about the axes.
  static RigidMotion quarter_turns(Quat rotation, Vec3d from = {}, Vec3d to = {});

  Vec3d point(Vec3d p) const { return R * (p - from) + to; }
  Vec3d vector(Vec3d v) const { return R * v; }
  Vec3d point_back(Vec3d p) const { return R.transpose_times(p - to) + from; }
  Vec3d vector_back(Vec3d v) const { return R.transpose_times(v); }
};

// Moves everything in the scene that has a position or a direction: bodies with their velocities, joints,
// ends of springs, bushings with their matrices, loads, gravity. Throws std::invalid_argument for scenes with
// particles, because their domain has the axes of the world.
scene::Scene moved(const scene::Scene& scene, const RigidMotion& motion);

// Rounds all positions, axes, quaternions, lengths and pitches to decimals with this many significant digits,
// then normalises axes and quaternions, as reading them from a file does.
scene::Scene rounded(const scene::Scene& scene, int digits);

// The largest unit in the last place of such decimals: of positions and lengths relative to `size`, of axes
// and quaternions absolute.
double last_place(const scene::Scene& scene, int digits, double size);

// The same data, each number changed by at most `amount` (lengths: times `size`) at random.
scene::Scene perturbed(const scene::Scene& scene, double amount, double size, std::mt19937_64& random);

// Bodies, joints, couplers and forces in another order.
struct Reordered {
  scene::Scene scene;
  std::vector<std::size_t> body, joint;  // new index of each one of the given scene
};
Reordered reordered(const scene::Scene& scene, std::mt19937_64& random);

// The scene in other units: those of length and mass are smaller by these factors, that of time is the same.
// Throws std::invalid_argument for a damping that applies to angles and lengths of one joint.
scene::Scene in_units(const scene::Scene& scene, double length, double mass);

// Uniform over all rotations.
Quat random_rotation(std::mt19937_64& random);

}  // namespace tandem::test
