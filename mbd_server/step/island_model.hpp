// The model of some free bodies and of the ground, apart from the others.
#pragma once

#include "mbd_server/solve/free_bodies.hpp"

namespace tandem::mbd {

struct IslandModel {
  Model model;
  std::vector<int> shapes;  // of the whole model (shapes of the island), ascending
};

// `bodies`: ascending indices in `free`. Links, shapes and freedoms keep their order.
IslandModel island_model(const Model& whole, const std::vector<FreeBodies::Body>& free,
                         const std::vector<int>& bodies);

}  // namespace tandem::mbd
