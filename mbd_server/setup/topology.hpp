// The spanning tree of the graph of bodies and joints, and the joints that the tree has to cut.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "mbd_server/model/indices.hpp"

namespace tandem::mbd {

struct Topology {
  struct Edge {
    int joint = none;       // that connects the body to its inboard body; none: the body is free
    int inboard = none;     // body on the other side; none: the ground
    bool reversed = false;  // the body is the parent of the joint
  };
  std::vector<Edge> edges;   // (bodies)
  std::vector<int> outward;  // bodies, inboard before outboard
  std::vector<int> cuts;     // joints of the scene that close loops, ascending
};

// Joints whose coordinate is needed (driven, with a rate, a force or a coupler) and fixed joints are in the
// tree; the rest of the tree is as shallow as possible, because loops then share few joints. Of two equal
// joints the later one is cut. Throws Error{scene} where joints that need their coordinate form a loop.
Topology find_topology(const scene::Scene& scene);

}  // namespace tandem::mbd
