// The two sides of an open mesh: a body touches it from the side of its normals only.
#pragma once

#include <optional>
#include <span>

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

// Point i of shape a on the back of the mesh b, as a feature with the normal of the back; none where the body
// is in front of the nearest one of these faces. `faces`: those near the point. A sphere, and each end of a
// capsule or cylinder, is behind a face if its centre is; a box or hull if its middle is.
std::optional<ContactFeature> on_back(const Model& model, int a, int b, std::size_t i,
                                      const std::vector<LinkMotion>& links, std::span<const int> faces);

// Whether a point is above or below a face of the mesh, to the distance eps [m].
bool is_above(const ContactMesh& mesh, int face, const Vector3d& p, double eps);

}  // namespace tandem::mbd
