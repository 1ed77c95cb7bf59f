// The two large parts of parse().
#pragma once

#include "common/scene/model.hpp"
#include "common/scene/node.hpp"

namespace tandem::scene {

Mbd parse_mbd(const Node& node);

// `mbd` (or null) gives the bodies that walls are fixed to.
Dem parse_dem(const Node& node, const Mbd* mbd);

// Reads the name of a body or "ground"; an absent key is the ground.
BodyId read_body(const Node& node, const char* key, const std::vector<std::string>& bodies);

// Names of a list of things, in order.
template <class T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& thing : things) names.push_back(thing.name);
  return names;
}

}  // namespace tandem::scene
