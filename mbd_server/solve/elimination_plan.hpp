// The order in which joints and connections are eliminated, and where the blocks between connections lie.
// Made once from the topology.
//
// Links are visited inward. A connection is eliminated at the link where the branches of its two ends meet,
// before the joint of that link; until then it is active on the links between. Connections that are active
// together, or that elimination ties together, share a block.
#pragma once

#include <vector>

#include "mbd_server/solve/linearisation.hpp"

namespace tandem::mbd {

struct EliminationPlan {
  EliminationPlan(const Model& model, const std::vector<Connection>& list);

  struct Active {
    int connection;
    bool side_b;
    bool merges;  // the branches of both ends come together here already
    int slot;     // of its blocks on the joint of this link, counted over all links
  };
  // A neighbour that is eliminated later, with the places of the two blocks between.
  struct Neighbour {
    int connection;
    bool side_b;                  // by which the neighbour is active where this one is eliminated
    int row_block, column_block;  // (k, l) and (l, k) in the values
  };
  struct PerLink {
    std::vector<Active> active;
    std::vector<int> blocks;  // (active x active): place of block (k, l)
    std::vector<int> own;     // connections eliminated here, in order
  };
  struct PerConnection {
    int diagonal = 0;  // place of its own block
    std::vector<Neighbour> later;
    std::vector<int> updates;  // (later x later): place of block (l, m)
  };
  std::vector<PerLink> links;
  std::vector<PerConnection> connections;
  int slots = 0, values = 0;  // numbers of slots, of values in all blocks
};

}  // namespace tandem::mbd
