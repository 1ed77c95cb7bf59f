// The walls of bodies as triangles in body frames, and what is between two points.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "particles/base/uninitialised.hpp"
#include "particles/geometry/facet.hpp"
#include "particles/geometry/path.hpp"

namespace tandem::sph {

// A facet near a point, in world axes.
struct NearFacet {
  Vec3d a, b, c, normal;  // [m], [-]
  std::uint32_t body = 0;
};

// Facets near one point.
struct NearWalls {
  static constexpr int most = 256;
  dem::UninitialisedArray<NearFacet, most> facet;
  int count = 0;
  bool overflow = false;  // there are more than `most`
};

class Walls {
 public:
  Walls() = default;
  // One mesh for each body, in the frame of the body. Points search facets within `reach` [m].
  // Error{scene} for a degenerate triangle, with its body and number.
  Walls(const std::vector<TriangleMesh>& meshes, double reach);

  std::uint32_t bodies() const { return static_cast<std::uint32_t>(poses_.size()); }
  bool any() const { return !facets_.empty(); }
  const std::vector<dem::BodyPose>& poses() const { return poses_; }
  void set_pose(std::uint32_t body, const dem::BodyPose& pose) { poses_[body] = pose; }

  // Facets that may have a point within `radius` <= reach of x, in ascending order of body and facet.
  void find(Vec3d x, double radius, NearWalls& found) const;
  // Is a facet between two points, less than the reach apart? The answer for (x, y) is that for (y, x).
  bool between(Vec3d x, Vec3d y) const;
  // Did a point that moved from `then` to `now` pass a wall, while the bodies moved from these poses to
  // theirs?
  bool passed(const std::vector<dem::BodyPose>& poses_then, Vec3d then, Vec3d now) const;
  // Bound of how far any facet is from where it was with these poses [m].
  double moved_from(const std::vector<dem::BodyPose>& poses_then) const;

 private:
  std::vector<dem::Facet> facets_;
  std::vector<dem::FacetGrid> grids_;      // one per body
  std::vector<std::uint32_t> cell_start_;  // see dem::Surface
  std::vector<std::uint32_t> cell_facet_;
  std::vector<dem::BodyPose> poses_;
  std::vector<double> extent_;  // largest distance of a vertex from the origin of its body [m]
};

}  // namespace tandem::sph
