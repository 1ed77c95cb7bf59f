// Detects walls of different bodies that pass through each other. Walls are in contact with spheres only, so
// that a wheel falls through a floor unless a shape of contact, a joint, a stop or a spring supports it. The
// verdict reports such a run.
//
// Walls are surfaces (the triangles of boxes, cylinders, spheres and meshes) or half-spaces (planes). Two
// surfaces pass through each other where they overlap by more than a tolerance, a share of the thinner wall;
// a surface passes a plane where a vertex is that far behind it. A pair is checked again when its walls have
// moved relative to each other by a tenth of the thinner one.
//
// Faces of two walls in one plane, and coincident edges, cross or miss each other by rounding alone, so that
// a box could fall through another of the same section without an edge that crosses a face. Therefore a
// closed surface of the two shrinks by the tolerance first (wall_surface.hpp): what then still crosses the
// other overlaps it by more than the tolerance, and surfaces that only coincide do not cross.
//
// Not judged: walls of bodies that a joint connects (for a body on the ground: with the wall that contains
// the joint's point), that are welded, that overlap in the pose of the scene, and two planes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"
#include "coordinator/verdict/wall_surface.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// Walls in contact may overlap by this share of the thinner one.
inline constexpr double wall_depth_share = 0.01;  // [-]

struct WallCrossing {
  std::string wall_a, body_a, wall_b, body_b;
  double time = 0;   // of the first detection [s]
  double depth = 0;  // largest value [m]
  double share = 0;  // of the thickness of the thinner wall [-]
};

class WallWatch {
 public:
  // Throws Error{internal} where a mesh is missing. `scene` must outlive this object.
  WallWatch(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);

  // Poses of all bodies at `time` [s]. `last`: at the end of the run every pair that has moved is checked;
  // before, each call does a limited amount of work.
  void observe(double time, const std::vector<protocol::BodyState>& bodies, bool last = false);

  bool judges() const { return !pairs_.empty(); }
  const std::vector<WallCrossing>& crossings() const { return crossings_; }
  // Pairs that are not judged, and why: whole sentences.
  const std::vector<std::string>& not_judged() const { return not_judged_; }

 private:
  struct Pair {
    std::size_t a = 0, b = 0;  // surfaces; a plane is b
    double thickness = 0;      // of the thinner one [m]
    // Whether the other wall is inside this one in the pose of the scene: such a wall counts as a shell
    // without an inside.
    bool hollow_a = false, hollow_b = false;
    Pose last;  // pose of a in the frame of b at the last check
    std::size_t crossing = none;
  };
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  std::vector<const scene::Wall*> walls_to_judge(const std::vector<NamedMesh>& meshes);
  bool may_meet(const WallSurface& a, const WallSurface& b) const;
  void make_pairs();
  double depth(const Pair& pair, const Pose& a_in_b);
  bool is_near(const Pair& pair, const Pose& a_in_b) const;
  std::size_t group_of(BodyId body) const;
  Pose pose_of(BodyId body, const std::vector<protocol::BodyState>& bodies) const;

  const scene::Scene& scene_;
  const std::vector<scene::Wall> walls_;  // of all particle solvers
  std::vector<std::size_t> group_;        // of welded bodies, by body; the ground last
  std::vector<WallSurface> surfaces_;
  std::vector<Pair> pairs_;
  std::size_t next_ = 0;  // pair to check first, so that all pairs are checked in turn
  std::vector<WallCrossing> crossings_;
  std::vector<std::string> not_judged_;
  double budget_ = 0;  // remaining tests of an edge against a triangle
};

}  // namespace tandem::launch
