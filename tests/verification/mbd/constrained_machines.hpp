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
  double end = 0;  // how long it runs here [s]
  // The same with rounded data; 0: as long. Afterwards the machine passes a flat position, in which bars of
  // lengths that do not quite fit block each other.
  double rounded_end = 0;
  // By theory; -1: not given here.
  int degrees_of_freedom = -1;
  int redundant = -1;        // equations that depend on others
  double smallest_loop = 1;  // share of the machine's size: of it the decimals of positions are a larger part
};

// Shafts, doors, Cardan shafts, planar and spatial linkages, guides, gears: all names differ. Step 2 ms.
std::vector<ConstrainedMachine> constrained_machines();
// launch/scenes/mbd/*.json, cut short.
std::vector<ConstrainedMachine> shipped_machines();

}  // namespace tandem::mbd
