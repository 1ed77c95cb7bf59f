// The iteration matrix as local blocks, one for each link and each connection; a block is independent of the
// tree.
//
// With increments x of the coordinates, each link has y = [psi; eta; eps] (18): its displacement, and the
// weighted changes of its velocity and acceleration without their rotation with the link
// (docs/mbd_equations.md):
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

#include "mbd_server/forces/connection.hpp"
#include "mbd_server/model/model.hpp"

namespace tandem::mbd {

struct LinkBlocks {
  Matrix6x18d K;
  Matrix18x3d Y;  // the first columns, as many as the joint has freedoms; likewise below
  Matrix6x3d S, turn;
  Vector3d diag;
};

// Changes of the wrench on the second link of a pair in contact of free bodies (free_bodies.hpp): per
// displacement of the first and of the second, and per change of the velocity of the second relative to the
// first.
struct ContactPairBlocks {
  Matrix6d by_first, by_second, by_velocity;
};

// The force elements in the order in which they enter the matrix (forces).
std::vector<std::size_t> order_in_matrix(const Model& model);

// The connections: closures, then force elements, geometric stiffnesses and forces over a coordinate
// elsewhere, at last contacts. The blocks of a link are computed when the elimination visits it
// (Dynamics::linearise_link): stored for all links they would be most of the memory traffic of a step.
struct Linearisation : ConnectedForces {
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

  int first_contact = 0;                      // index of the first connection of contacts
  std::vector<ContactPlace> contact_places;   // (pairs in contact)
  std::vector<ContactPairBlocks> free_pairs;  // (pairs in contact of free bodies)
  std::vector<std::vector<int>> of_forces;    // what ForceElement::connect() gave (forces)
  // none: one end is on the ground, or the closure has no geometric stiffness (closures)
  std::vector<int> stiffness_connection;
  // Of a size over a joint coordinate; none: the force acts on the coordinate itself, or on the ground, or
  // the coordinate is prescribed (joint forces).
  std::vector<int> joint_force_connection;
};

}  // namespace tandem::mbd
