// Finds which features of two shapes touch, or may touch soon (ContactFeature), and the pairs of shapes that
// are near.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/kinematics/kinematics.hpp"
#include "mbd_server/state/contact_point.hpp"

namespace tandem::mbd {

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
// `travel`: the largest ways of the shapes in that time where they are known, else those at their rates
// [m] (shapes).
void find_pairs(const Model& model, const std::vector<LinkMotion>& links, double h,
                std::vector<NearPair>& pairs, const std::vector<double>* travel = nullptr);

// Families and numbers of codes (ContactFeature::code), with 24 bits for each of two numbers.
enum class Family : std::int64_t {
  corner = 0,
  end_a,
  end_b,
  lines,
  face_a,
  face_b,
  hull,
  on_mesh,
  mesh_corner
};
inline std::int64_t code_of(Family family, std::int64_t first, std::int64_t second = 0) {
  return (static_cast<std::int64_t>(family) << 48) | (first << 24) | second;
}

// Two lines whose angle has a sine below this count as parallel.
inline constexpr double parallel = 0.05;
// An edge, and a corner on a capsule, touch where the other body is in front of the surfaces that meet there,
// to the sine of this angle: a body that lies flat on a surface tilts a little to either side.
inline constexpr double tilt_of_edge = 0.17;

}  // namespace tandem::mbd
