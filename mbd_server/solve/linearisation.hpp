// The iteration matrix as local blocks, one for each link and each connection; a block is independent of the
// tree.
//
// With increments x of the coordinates, each link has y = [psi; eta; eps] (18): its displacement, and the
// weighted changes of its velocity and acceleration without their rotation with the link (docs/mbd.md,
// "Derivatives and elimination"):
//   y_i = y_p + Y_i x_i                          outward
//   f_i = K_i y_i + sum of children (f_c + turn_c x_c) + C z        inward; f: change of force, co-rotated
//   row of the joint: S_i^T f_i + diag_i x_i,    row of a connection: R_a y_a + R_b y_b - soft z
// A connection is a closure, whose z is a multiplier; or a spring, cylinder or bushing, whose z is its change
// of force; or the geometric stiffness of a closure; or the tension of a rope; or a force that depends on a
// coordinate elsewhere. Ropes, and couplers of more than two joints, connect more than two links.
//
// Contacts between moving links are connections of two kinds. That of a pair of links has the change of its
// wrench as z. Where a group of links in contact has more pairs than links, as in a heap, each link has one
// connection instead: z is the change of the wrench on that link by the motion of all its neighbours. It acts
// on that link and depends on the others only, so that the system has six unknowns for each body.
#pragma once

#include <utility>
#include <vector>

#include "mbd_server/model/model.hpp"

namespace tandem::mbd {

using Matrix6x18d = Eigen::Matrix<double, 6, 18>;
using Matrix18x3d = Eigen::Matrix<double, 18, 3>;
using Matrix6x3d = Eigen::Matrix<double, 6, 3>;

struct LinkBlocks {
  Matrix6x18d K;
  Matrix18x3d Y;  // the first columns, as many as the joint has freedoms; likewise below
  Matrix6x3d S, turn;
  Vector3d diag;
};

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

// Changes of the wrench on the second link of a pair in contact of free bodies (free_bodies.hpp): per
// displacement of the first and of the second, and per change of the velocity of the second relative to the
// first.
struct ContactPairBlocks {
  Matrix6d by_first, by_second, by_velocity;
};

// The connections. The blocks of a link are computed when the elimination visits it
// (Dynamics::linearise_link): stored for all links they would be most of the memory traffic of a step.
struct Linearisation {
  explicit Linearisation(const Model& model);
  // Pairs of moving links in contact, sorted: the last of the connections, but for those of free bodies
  // (links).
  void set_contacts(const std::vector<std::pair<LinkIndex, LinkIndex>>& links,
                    const std::vector<bool>& is_free);
  void make_blocks(std::size_t first);

  // Where the wrench of a pair in contact is.
  struct ContactPlace {
    int connection = none;  // of the pair; none: each of the two links has one by its neighbours
    int of_a = none, side_of_b = 0, of_b = none, side_of_a = 0;
    int free_pair = none;  // of free bodies instead
  };

  // Closures, then springs, cylinders, bushings and geometric stiffnesses between moving links.
  std::vector<Connection> connections;
  int first_contact = 0;                      // index of the first connection of contacts
  std::vector<ContactPlace> contact_places;   // (pairs in contact)
  std::vector<ContactPairBlocks> free_pairs;  // (pairs in contact of free bodies)
  std::vector<ConnectionBlocks> blocks;       // (connections)
  // none: one end is on the ground; cylinder_connection (elements): also for motors; stiffness_connection:
  // also where the closure has no geometric stiffness
  std::vector<int> spring_connection, cylinder_connection, bushing_connection, stiffness_connection;
  std::vector<int> tension_connection;            // (ropes)
  std::vector<std::vector<int>> span_connection;  // (ropes, spans)
  // Of a size over a joint coordinate; none: the force acts on the coordinate itself, or on the ground, or
  // the coordinate is prescribed.
  std::vector<int> load_connection, joint_force_connection;
  // Forces between a link and the ground: part of K.
  std::vector<int> grounded_of;  // index in `grounded` (links); none: there is no such force
  std::vector<Matrix6x18d> grounded;
};

}  // namespace tandem::mbd
