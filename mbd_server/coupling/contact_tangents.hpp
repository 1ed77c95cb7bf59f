// How the contacts of each boundary body with other bodies and the ground respond to a small motion of this
// body alone: for the coordinator's estimate of the stability of a window.
#pragma once

#include "mbd_server/contact/contact_force.hpp"
#include "protocol/messages.hpp"

namespace tandem::mbd {

// Bodies that are fixed to each other move together. Of the state to which `links` belong. Bodies without
// contact are left out.
void contact_tangents(const Model& model, const State& state, const std::vector<LinkMotion>& links,
                      std::vector<protocol::BodyTangent>& tangents);

}  // namespace tandem::mbd
