#include "mbd_server/contact/mesh_search.hpp"

namespace tandem::mbd {

MeshSearch::MeshSearch(const Model& model, int a, int b, const std::vector<LinkMotion>& links, double reach,
                       double depth, std::vector<ContactFeature>& out)
    : model_(model),
      links_(links),
      a_(model.contact.shape(a)),
      b_(model.contact.shape(b)),
      mesh_(*b_.mesh),
      index_a_(a),
      index_b_(b),
      reach_(reach),
      depth_(depth),
      eps_(rounding * mesh_.bound()),
      out_(out) {
  const LinkMotion &la = links[nth(a_.link)], &lb = links[nth(b_.link)];
  R_ = lb.R_WL.transpose() * la.R_WL;
  p_ = lb.R_WL.transpose() * (la.p_WL - lb.p_WL);
}

Vector3d MeshSearch::outward(int f, int edge) const {
  const ContactMesh::Face& face = mesh_.face(f);
  for (std::size_t k = 0; k < 3; ++k)
    if (face.edges[k] == edge)
      return (mesh_.point(face.corners[(k + 1) % 3]) - mesh_.point(face.corners[k]))
          .cross(face.normal)
          .normalized();
  return Vector3d::Zero();
}

}  // namespace tandem::mbd
