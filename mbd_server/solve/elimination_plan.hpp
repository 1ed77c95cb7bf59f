// The order in which joints and connections are eliminated, and the storage of the blocks between
// connections. Made once from the topology.
//
// Links are visited inward. A connection is eliminated at the link where the branches of its two ends meet,
// before the joint of that link; until then it is active on the links between. Connections that are active
// together, or that an elimination couples, share a block.
#pragma once

#include <vector>

#include "mbd_server/solve/linearisation.hpp"

namespace tandem::mbd {

struct EliminationPlan {
  EliminationPlan(const Model& model, const std::vector<Connection>& list);

  struct Active {
    int connection;
    int side;
    bool merges;      // the branches of both ends meet here
    int joint_block;  // index of its blocks on the joint of this link, counted over all links
    bool acts = true, depends = true;  // whether its C and its R are other than zero on this side
  };
  // A neighbour that is eliminated later, with the indices of the two blocks between.
  struct Neighbour {
    int connection;
    int side;  // the side by which the neighbour is active where this connection is eliminated
    int row_block, column_block;  // (k, l) and (l, k) in the values
  };
  // Two branches of a connection of more than two links meet at a link: one side is added to the other.
  struct Merge {
    int connection, from, into;
  };
  struct PerLink {
    std::vector<Merge> merges;
    std::vector<Active> active;
    std::vector<int> blocks;  // (active that depend x active that act): index of block (k, l)
    std::vector<int> own;     // connections eliminated here, in order
  };
  struct PerConnection {
    int diagonal = 0;  // index of its own block
    std::vector<Neighbour> later;
    std::vector<int> updates;  // (later x later): index of block (l, m)
  };
  std::vector<PerLink> links;
  std::vector<PerConnection> connections;
  int joint_blocks = 0, values = 0;  // number of joint blocks, number of values in all blocks
};

}  // namespace tandem::mbd
