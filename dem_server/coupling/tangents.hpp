// Stiffness and damping of the contacts of each body, from those of single
// contacts.
#pragma once

#include <vector>

#include "dem_server/step/contact_tangent.hpp"
#include "protocol/messages.hpp"

namespace tandem::dem {

// Sums over the contacts, in their order, of the bodies that carry the slots;
// the ground does not move and has none. What the turning of the present loads
// with the body adds is left out.
std::vector<protocol::BodyTangent> sum_tangents(const std::vector<ContactTangent>& contacts,
                                                const std::vector<BodyId>& slot_body);

}  // namespace tandem::dem
