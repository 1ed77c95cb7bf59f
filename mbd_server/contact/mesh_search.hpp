// A body beside a triangle mesh, seen in the frame of the mesh: what the searches for its features
// (mesh_features.hpp) share.
#pragma once

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

// As tilt_of_edge, for a corner on a face.
inline constexpr double tilt_of_corner = 0.35;
// Places nearer to an edge than this share of the size of the mesh are on it.
inline constexpr double rounding = 1e-12;

class MeshSearch {
 public:
  // As find_mesh_features(). All that is passed must outlive this object.
  MeshSearch(const Model& model, int a, int b, const std::vector<LinkMotion>& links, double reach,
             double depth, std::vector<ContactFeature>& out);

 protected:
  using Kind = ContactShape::Kind;
  using Bend = ContactMesh::Bend;

  static std::size_t nth(int i) { return static_cast<std::size_t>(i); }
  // A point of link a in the frame of the mesh, and the reverse.
  Vector3d local(const Vector3d& p) const { return p_ + R_ * p; }
  Vector3d back(const Vector3d& p) const { return R_.transpose() * (p - p_); }
  // Out of face f in its plane, across its edge.
  Vector3d outward(int f, int edge) const;

  const Model& model_;
  const std::vector<LinkMotion>& links_;
  const ContactShape &a_, &b_;
  const ContactMesh& mesh_;
  int index_a_, index_b_;
  double reach_, depth_, eps_;
  Matrix3d R_;  // frame of link a to that of link b
  Vector3d p_;
  std::vector<int> near_;  // faces near what is looked at
  std::vector<ContactFeature>& out_;
};

// Adds the features of the edges of the body on edges of the mesh that stick out.
void add_edges_on_mesh(const MeshSearch& search);
// Adds the features of the corners of the mesh that stick out on faces of the body or on the side of a
// capsule.
void add_mesh_corners(const MeshSearch& search);

}  // namespace tandem::mbd
