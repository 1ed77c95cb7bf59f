// The response of a liquid to bodies in it, and the directions of a body in which it acts apart from the
// others.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/schemes/body_modes.hpp"
#include "coordinator/schemes/liquid_map.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// All points of the response of one body.
using Response = std::span<const protocol::BodyResponse>;
// Of each body that responds.
std::vector<Response> by_body(const std::vector<protocol::BodyResponse>& responses);

// The responses of a body along the directions in which its impulse over a window acts apart from each other,
// and these directions, of unit modal mass.
std::vector<std::pair<LiquidMode, Vector6>> liquid_modes(Response response, const scene::Body& body,
                                                         const scene::Freedom& freedom, const Pose& pose,
                                                         double window);
// Impulse that the body passes to the liquid in a window over the change of its velocity at the begin (6 x 6)
// [kg] [kg m] [kg m2].
Matrix6 passed_in(Response response, const scene::Body& body, const scene::Freedom& freedom, const Pose& pose,
                  double window);

}  // namespace tandem::launch
