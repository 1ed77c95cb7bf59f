// A named number of a scene: a parameter, or a figure taken from a library.
#pragma once

#include <string>

namespace tandem::scene {

struct Parameter {
  std::string name;
  double value = 0;  // in `unit`
  std::string unit;  // "deg", "rad", or one of SI; empty: not said
};

}  // namespace tandem::scene
