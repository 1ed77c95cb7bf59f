// Stiffness and damping of the contacts of each body, as the protocol sends them.
#pragma once

#include <vector>

#include "dem_server/engine/contact_tangent.hpp"
#include "protocol/messages.hpp"

namespace tandem::dem {

// One tangent for each boundary body in contact; the ground does not move and has none. The geometric
// stiffness, by which the present loads rotate with the body, is neglected.
std::vector<protocol::BodyTangent> body_tangents(const std::vector<WallTangent>& of_body,
                                                 const std::vector<BodyId>& boundary_bodies);

}  // namespace tandem::dem
