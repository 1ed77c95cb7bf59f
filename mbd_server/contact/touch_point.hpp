// The point where two shapes touch.
#pragma once

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

using Matrix3x6d = Eigen::Matrix<double, 3, 6>;

struct Touch {
  Vector3d n;      // normal, from a to b, unit
  Vector3d p;      // point of contact: in the middle between the two surfaces along n [m]
  double gap = 0;  // [m]
  // Changes of n and p per displacement of the links. That of the gap is n . (dx_b - dx_a) at p.
  // Zero without derivatives.
  Matrix3x6d dn_a = Matrix3x6d::Zero(), dn_b = dn_a, dp_a = dn_a, dp_b = dn_a;
};
enum class Derivatives { with, without };

// Place of a point of a link in the frame of that link.
inline Vector3d in_link(const LinkMotion& link, const Vector3d& p) {
  return link.R_WL.transpose() * (p - link.p_WL);
}
inline const LinkMotion& link_of(const Model& model, int shape, const std::vector<LinkMotion>& links) {
  return links[static_cast<std::size_t>(model.contact.shape(shape).link)];
}

}  // namespace tandem::mbd
