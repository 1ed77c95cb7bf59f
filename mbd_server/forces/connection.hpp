// Connections of the iteration matrix, each with unknowns of its own between links (solve/linearisation.hpp
// says what they are), and the forces between a link and the ground.
#pragma once

#include <cstddef>
#include <vector>

#include "mbd_server/model/indices.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

using Matrix6x18d = Eigen::Matrix<double, 6, 18>;
using Matrix18x3d = Eigen::Matrix<double, 18, 3>;
using Matrix6x3d = Eigen::Matrix<double, 6, 3>;

struct Connection {
  LinkIndex a = 0, b = 0;
  int size = 0;                   // of z, at most 6
  bool soft = false;              // a force law; else a closure
  bool direct = false;            // acts on the coordinates of its links themselves
  int first = none;               // of a closure: index of its first multiplier in lambda
  std::vector<LinkIndex> more{};  // further links, which all differ
  bool by_neighbours = false;     // acts on a only, and depends on the motion of b and `more` only

  int sides() const { return 2 + static_cast<int>(more.size()); }
  LinkIndex link(int side) const {
    return side == 0 ? a : (side == 1 ? b : more[static_cast<std::size_t>(side) - 2]);
  }
};

// Entries between z and the coordinate of a link itself, of a direct connection.
struct OnCoordinate {
  double column = 0, row = 0;
};

// The side of a connection on one link.
struct ConnectionSide {
  Matrix6d C = Matrix6d::Zero();        // (6 x size)
  Matrix6x18d R = Matrix6x18d::Zero();  // (size x 18)
  OnCoordinate on_q;
};

struct ConnectionBlocks {
  Matrix6d C_a, C_b;     // (6 x size)
  Matrix6x18d R_a, R_b;  // (size x 18)
  OnCoordinate on_q_a, on_q_b;
  std::vector<ConnectionSide> more;  // of Connection::more

  // By the number of the side: a, b, more.
  Matrix6d& C(int side) {
    return side == 0 ? C_a : (side == 1 ? C_b : more[static_cast<std::size_t>(side) - 2].C);
  }
  Matrix6x18d& R(int side) {
    return side == 0 ? R_a : (side == 1 ? R_b : more[static_cast<std::size_t>(side) - 2].R);
  }
  OnCoordinate& on_q(int side) {
    return side == 0 ? on_q_a : (side == 1 ? on_q_b : more[static_cast<std::size_t>(side) - 2].on_q);
  }
};

// The connections, and their blocks; a block belongs to the connection of the same index.
struct ConnectedForces {
  std::vector<Connection> connections;
  std::vector<ConnectionBlocks> blocks;
  // Forces between a link and the ground: part of K.
  std::vector<int> grounded_of;  // index in `grounded` (links); none: there is no such force
  std::vector<Matrix6x18d> grounded;
};

}  // namespace tandem::mbd
