// Machines with closed loops and redundant joints, as an engineer draws them, and the shipped scenes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::mbd {

struct ConstrainedMachine {
  std::string name;
  scene::Scene scene;
  // The same motion without redundant equations; none: none is known, or the scene has none itself.
  std::optional<scene::Scene> determinate;
  double end = 0.4;  // how long it runs here [s]
  int degrees_of_freedom = 1;
  int redundant = 0;  // equations that depend on others; with degrees_of_freedom -1: not given here
};

// Shafts, doors, Cardan shafts, planar and spatial linkages, guides, gears: all names differ. Step 2 ms.
std::vector<ConstrainedMachine> constrained_machines();
// launch/scenes/mbd/*.json, cut short.
std::vector<ConstrainedMachine> shipped_machines();

}  // namespace tandem::mbd
