// Stiffness and damping of the contacts of each body, as the other side is told.
#pragma once

#include <vector>

#include "dem_server/engine/contact_tangent.hpp"
#include "protocol/messages.hpp"

namespace tandem::dem {

// Of the bodies that carry the bodies and are touched; the ground does not move and has none. What the
// turning of the present loads with the body adds is left out.
std::vector<protocol::BodyTangent> body_tangents(const std::vector<WallTangent>& of_body,
                                                 const std::vector<BodyId>& boundary_bodies);

}  // namespace tandem::dem
