// Where two features touch, and how that changes with the displacements of their links.
#pragma once

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

using Matrix3x6d = Eigen::Matrix<double, 3, 6>;

// Distance of the shapes at that feature: negative where they overlap [m]. `rate` gets its rate [m/s].
double gap(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links,
           double* rate = nullptr);

// Place on the surface of b where the ball of a, or the line of a, is nearest to it; in the frame of link b
// [m].
Vector3d foot(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links);

struct Touch {
  Vector3d n;      // normal, from a to b, unit
  Vector3d p;      // point of contact: in the middle between the two surfaces along n [m]
  double gap = 0;  // [m]
  // Changes of n and p per displacement of the links. That of the gap is n . (dx_b - dx_a) at p.
  // Zero without derivatives.
  Matrix3x6d dn_a = Matrix3x6d::Zero(), dn_b = dn_a, dp_a = dn_a, dp_b = dn_a;
};
enum class Derivatives { with, without };
Touch touch(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links,
            Derivatives derivatives = Derivatives::with);

// Place of a point of a link in the frame of that link.
inline Vector3d in_link(const LinkMotion& link, const Vector3d& p) {
  return link.R_WL.transpose() * (p - link.p_WL);
}
inline const LinkMotion& link_of(const Model& model, int shape, const std::vector<LinkMotion>& links) {
  return links[static_cast<std::size_t>(model.contact.shape(shape).link)];
}

}  // namespace tandem::mbd
