// Which features of two shapes touch, or may touch soon: a ball of one shape (a corner, an end, a centre) on
// a plane, line, point or shape of the other, or two lines that cross. A feature stays for a step; features
// are found anew from step to step, and a code tells which is which.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

struct ContactFeature {
  enum class Kind {
    shape,         // the ball on the round shape or box b
    plane,         // the ball on a plane of b
    line,          // the ball on a line of b
    point,         // the ball on a ball of b
    lines,         // a line of a on a line of b
    rim_on_plane,  // the circle about `place_a` across `axis_a` on a plane of b
    rim_on_line,   // the same on a line of b
    watch  // the ball or the circle on a mesh b, where no other feature of this ball touches: what is nearest
           // changes
  } kind = Kind::shape;
  int a = none, b = none;  // shapes
  // Of shapes a and b. Features of one face have one code: their places tell them apart.
  std::int64_t code = 0;
  bool by_place = false;
  bool on_mesh = false;  // of a ball on a mesh: the place of contact tells it apart, and a `watch` finds it
  int face = none;       // of the mesh: one at the place of contact
  // In the frames of the links: centre of the ball, or a point of the line [m]; direction of the line, or
  // normal of the plane out of b. Lines a and b are oriented so that a x b points from a to b.
  Vector3d place_a = Vector3d::Zero(), axis_a = Vector3d::Zero(), place_b = Vector3d::Zero(),
           axis_b = Vector3d::Zero();
  double radius_a = 0, radius_b = 0;  // [m]
};

// Adds the features of the pair whose distance is at most `reach`, and further ones. `preferred`: the code of
// the pair's face or edges that touched last, or -1: among equals it stays.
// `depth`: of the deepest point of the pair; corners of a body are found so deep in a mesh [m].
void find_features(const Model& model, int a, int b, const std::vector<LinkMotion>& links, double reach,
                   std::int64_t preferred, std::vector<ContactFeature>& features, double depth = 0);

// A point of contact goes no deeper than this: from the surface to the middle of the thinner shape [m].
double thickness_at(const Model& model, const ContactFeature& feature);

// Pairs of shapes that may come into contact within a time h, and the distance that they may approach each
// other by then [m].
struct NearPair {
  int a = none, b = none;
  double reach = 0;
};
void find_pairs(const Model& model, const std::vector<LinkMotion>& links, double h,
                std::vector<NearPair>& pairs);

}  // namespace tandem::mbd
