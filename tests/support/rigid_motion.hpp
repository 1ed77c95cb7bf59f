// A multibody scene seen from another frame, and a scene whose data are decimals of few digits.
#pragma once

#include <random>

#include "common/scene/model.hpp"

namespace tandem::test {

// p -> R (p - from) + to, with the rotation as a quaternion and as a matrix. A point at `from` goes to `to`
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

// Everything of the scene that has a place or a direction moves: bodies with their velocities, joints, ends
// of springs, bushings with their matrices, loads, gravity. Throws std::invalid_argument where the scene has
// particles: their domain has the axes of the world.
scene::Scene moved(const scene::Scene& scene, const RigidMotion& motion);

// All positions, axes, quaternions, lengths and pitches as decimals of so many significant digits; axes and
// quaternions are of unit length afterwards, as in a scene that was read from a file.
scene::Scene rounded(const scene::Scene& scene, int digits);

// The largest unit in the last place of such decimals: of positions and lengths relative to `size`, of axes
// and quaternions as it is.
double last_place(const scene::Scene& scene, int digits, double size);

// The same data, each number changed by at most `amount` (lengths: times `size`) at random.
scene::Scene perturbed(const scene::Scene& scene, double amount, double size, std::mt19937_64& random);

// Bodies, joints, couplers and forces in another order.
struct Reordered {
  scene::Scene scene;
  std::vector<std::size_t> body, joint;  // where each of the given scene is now
};
Reordered reordered(const scene::Scene& scene, std::mt19937_64& random);

// The scene with all numbers in other units: those of length and of mass are so much smaller, that of time
// stays. Throws std::invalid_argument for a damping that holds for angles and lengths of one joint.
scene::Scene in_units(const scene::Scene& scene, double length, double mass);

// Uniform over all rotations.
Quat random_rotation(std::mt19937_64& random);

}  // namespace tandem::test
