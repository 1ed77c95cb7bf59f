// The walls of bodies as triangles in body frames.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "sph_server/neighbours/walls_view.hpp"

namespace tandem::sph {

// Facets near one point.
struct NearWalls {
  std::vector<NearFacet> facet;  // those of a body follow each other
  int count = 0;
};

class Walls {
 public:
  Walls() = default;
  // One mesh for each body, in the frame of the body. Points search facets within `reach` [m]. slip: of each
  // body, true without friction; empty: all have friction.
  // Error{scene} for a degenerate triangle, with its body and number.
  Walls(const std::vector<TriangleMesh>& meshes, double reach, const std::vector<bool>& slip = {});

  std::uint32_t bodies() const { return static_cast<std::uint32_t>(poses_.size()); }
  const std::vector<particles::BodyPose>& poses() const { return poses_; }
  void set_pose(std::uint32_t body, const particles::BodyPose& pose) { poses_[body] = pose; }
  // Refers to this object, and to its poses as they change.
  WallsView view() const;

  // All facets that may have a point within `radius` [m] of x.
  void find(Vec3d x, double radius, NearWalls& found) const;
  // Those of them that x may see.
  void find_seen(Vec3d x, double radius, NearWalls& found) const;
  // See WallsView.
  bool between(Vec3d x, Vec3d y) const { return view().between(x, y); }
  // Bound of how far any facet is from where it was with these poses [m].
  double moved_from(const std::vector<particles::BodyPose>& poses_then) const;
  // Bound of the speed of any facet relative to `frame` [m/s].
  double largest_speed(Vec3d frame) const;

  const std::vector<particles::Facet>& facets() const { return facets_; }
  double margin() const { return margin_; }  // see crosses() [m]
  // The arrays of WallsView.
  const std::vector<particles::FacetGrid>& grids() const { return grids_; }
  const std::vector<std::uint32_t>& cell_start() const { return cell_start_; }
  const std::vector<std::uint32_t>& cell_facet() const { return cell_facet_; }
  const std::vector<std::uint8_t>& slip() const { return slip_; }
  const std::vector<std::uint8_t>& beyond() const { return beyond_; }
  const std::vector<std::uint32_t>& surface() const { return surface_; }
  // Has any facet a closed surface?
  bool any_closed() const { return any_closed_; }

 private:
  std::vector<particles::Facet> facets_;
  std::vector<particles::FacetGrid> grids_;  // one per body
  std::vector<std::uint32_t> cell_start_;    // see particles::Surface
  std::vector<std::uint32_t> cell_facet_;
  std::vector<particles::BodyPose> poses_;
  std::vector<std::uint8_t> slip_, beyond_;  // see WallsView
  std::vector<std::uint32_t> surface_;
  bool any_closed_ = false;
  double margin_ = 0;
  std::vector<std::array<Vec3d, 8>> corners_;  // of a box around each body, in its frame [m]
};

}  // namespace tandem::sph
