// What a scene has besides bodies and particles, for pictures: regions of sensors, inlets and outlets as
// frames of lines, walls by name, and arrows on surfaces that run, as belts do.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/report/frame.hpp"

namespace tandem::launch {

struct Region {
  std::string words;  // "flow (sensor)"
  Vec3d at;           // in its middle, in the world [m]
  Vec3d colour;
  std::vector<std::pair<Vec3d, Vec3d>> lines = {};  // its edges; none of a wall, which is drawn
};

// Those of the scene at its start: walls of the ground, sensors, inlets, outlets.
std::vector<Region> regions_of(const scene::Scene& scene);

struct Arrow {
  Vec3d from, to;  // on the surface [m]
  Vec3d normal;    // of the surface there [-]
};

// On each wall with a surface velocity, in the direction that it has at the time of the frame.
std::vector<Arrow> belt_arrows(const scene::Scene& scene, const Frame& frame);

}  // namespace tandem::launch
