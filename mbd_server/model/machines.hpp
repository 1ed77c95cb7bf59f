// Links that joints connect with each other. What a scene has in several machines that only the ground holds
// together is judged machine by machine.
#pragma once

#include <vector>

#include "mbd_server/model/model.hpp"

namespace tandem::mbd {

// For each link the first one of its machine; none: the ground.
std::vector<int> machine_of_links(const Model& model);

}  // namespace tandem::mbd
