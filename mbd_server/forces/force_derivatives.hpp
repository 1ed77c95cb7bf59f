// Where the derivatives of a force enter the iteration matrix.
//
// A change of force in the world acts on its links; the rotation of the force with the links is elsewhere
// (Dynamics::linearise_link). Between two moving links the change is an unknown of its own, a connection;
// with an end on the ground it depends on one link, and is part of K of that link.
#pragma once

#include "mbd_server/forces/connection.hpp"
#include "mbd_server/forces/line_force.hpp"
#include "mbd_server/state/system.hpp"

namespace tandem::mbd {

// Makes the connections, once for a model.
class ForceConnections {
 public:
  explicit ForceConnections(ConnectedForces& to) : to_(to) {}
  // Of a force between two links with that many components: index of the connection, or none where it depends
  // on one link.
  int between(LinkIndex a, LinkIndex b, int size);
  int add(Connection connection);

 private:
  ConnectedForces& to_;
};

// Matrix of X -> V x X.
Matrix6d cross_matrix(const Vector6d& V);

class ForceDerivatives {
 public:
  // Change of a wrench by displacement, change of velocity and of acceleration of a link.
  using Form = Matrix6x18d;
  ForceDerivatives(const MatrixWeights& given, const std::vector<LinkMotion>& of, ConnectedForces& to)
      : weights(given), links(of), out(to) {}

  // K of a link by forces between it and the ground.
  Form& on(LinkIndex link) { return out.grounded[static_cast<std::size_t>(out.grounded_of[link])]; }
  // A force on a through `on_a` and the opposite on b through `on_b` (6 x size), which changes by `change_a`
  // with the motion of a and by `change_b` with that of b (size x 18).
  template <class OnA, class OnB>
  void place(int connection, LinkIndex a, LinkIndex b, const OnA& on_a, const OnB& on_b, const Form& change_a,
             const Form& change_b, int size);
  // Displacement of point p of a link, and change of its velocity without the rotation: d(v + w x p) =
  // at_point(psi x V + eta, p) + w x dp.
  Eigen::Matrix<double, 3, 18> displacement(const Vector3d& p) const;
  Eigen::Matrix<double, 3, 18> velocity(LinkIndex link, const Vector3d& p) const;
  void along_line(int connection, LinkIndex a, LinkIndex b, const SpringForce& f);

  const MatrixWeights& weights;
  const std::vector<LinkMotion>& links;
  ConnectedForces& out;
};

template <class OnA, class OnB>
void ForceDerivatives::place(int connection, LinkIndex a, LinkIndex b, const OnA& on_a, const OnB& on_b,
                             const Form& change_a, const Form& change_b, int size) {
  if (connection != none) {
    ConnectionBlocks& block = out.blocks[static_cast<std::size_t>(connection)];
    block.C_a.leftCols(size) = on_a;
    block.C_b.leftCols(size) = -on_b;
    block.R_a.topRows(size) = change_a.topRows(size);
    block.R_b.topRows(size) = change_b.topRows(size);
    return;
  }
  if (b > 0)
    on(b) -= on_b * (change_b.topRows(size) + (a == b ? Form(change_a) : Form(Form::Zero())).topRows(size));
  if (a > 0)
    on(a) += on_a * (change_a.topRows(size) + (a == b ? Form(change_b) : Form(Form::Zero())).topRows(size));
}

}  // namespace tandem::mbd
