// The equations of motion in joint space,
//   r(t, q, u, u', lambda) = B^T (M Y' + Phi_z^T lambda - Q) = 0          ([MbdDem] eq. 5)
// by one outward and one inward pass (recursive Newton-Euler), and the closures' equations phi. B, the
// velocity transformation, is never formed: its columns are the motion subspaces of the joints between a body
// and the ground, and B^T is the inward pass.
//
// Works on buffers of fixed size: no call after the first one allocates.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "mbd_server/constraints/equations.hpp"
#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/forces/force_element.hpp"
#include "mbd_server/kinematics/kinematics.hpp"
#include "mbd_server/solve/linearisation.hpp"
#include "mbd_server/state/system.hpp"

namespace tandem::mbd {

// Change of a wrench that is constant in the world per displacement of the link on which it acts, less its
// rotation with the link: -psi x* wrench.
inline Matrix6d rotation_of(const Vector6d& wrench) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = skew(wrench.head<3>());
  m.topRightCorner<3, 3>() = m.bottomLeftCorner<3, 3>() = skew(wrench.tail<3>());
  return m;
}

class Dynamics {
 public:
  explicit Dynamics(const Model& model);

  // Kinematics and residual at the state, with the state's loads on the boundary bodies. Where `driven` is
  // given, it is added to the prescribed accelerations (motions).
  const VectorXd& residual(const State& state, const VectorXd* driven = nullptr);
  // The part of it without the inward pass: kinematics; inertia() of each link, and its force(), the inertia
  // force less the loads on this link alone. Returns the part of the residual that comes from forces on
  // single coordinates. Afterwards, residual() must be called before anything below.
  const VectorXd& local_forces(const State& state);
  const Matrix6d& inertia(LinkIndex i) const { return loads_[i].I; }
  const Vector6d& force(LinkIndex i) const { return loads_[i].F; }
  // Inertia of motors on a coordinate, beside that of the links.
  double rotor(int u) const { return rotors_.size() > 0 ? rotors_[u] : 0; }

  const VectorXd& last_residual() const { return residual_; }
  // Equations of the closures at the last residual(); those below their round-off are zero (equations).
  const VectorXd& constraint(Level level) const { return phi_[static_cast<std::size_t>(level)]; }

  // Derivatives at the state of the last residual(), which the increment x has reached: for the
  // connections, and for one link with a parent.
  void linearise(const MatrixWeights& weights, Linearisation& out) const;
  void linearise_link(LinkIndex i, const MatrixWeights& weights, const VectorXd& x, LinkBlocks& out) const;

  const std::vector<LinkMotion>& links() const { return links_; }
  const std::vector<EquationValue>& equations() const { return equations_; }
  // At the last residual(): the wrench that the joint of a link transmits to it, without the forces on that
  // joint's coordinate and without couplers; and the kinetic energy [J].
  const Vector6d& transmitted(LinkIndex i) const { return loads_[i].F; }
  double kinetic_energy() const { return kinetic_energy_; }
  // States of first order of the elements and their rates at the last residual() or local_forces().
  const VectorXd& states() const { return z_; }
  const VectorXd& state_rates() const { return zdot_; }

  // Whether an increment changes the gap of each stiff contact of the last residual() by less than
  // ContactPoint::finest.
  bool is_fine(const VectorXd& dx) const;

  // Pairs of moving links in contact in the last residual(), sorted.
  const std::vector<std::pair<LinkIndex, LinkIndex>>& links_in_contact() const { return moving_contacts_; }

 private:
  // Quantities of one link.
  struct Load {
    Matrix6d I;  // inertia
    Vector6d F;  // inertia force less applied loads; after residual() of this link and everything outboard
    bool applied = false;  // whether some load acts on it
  };

  void add_link_forces(const State& state, const VectorXd* driven);
  void add_inertia(std::size_t link);
  // Force and torque at point p of a link, of constant direction in the world.
  void apply(LinkIndex link, const Vector3d& p, const Vector3d& force, const Vector3d& torque);
  void apply(LinkIndex link, const Vector6d& wrench);
  void mark_applied(LinkIndex link);
  class Receiver;
  void apply_loads(const State& state);
  void apply_forces(const State& state);
  void apply_closures(const State& state);
  void apply_contacts(const State& state);
  void keep_contacts_of_motions(const State& state);
  std::pair<LinkIndex, LinkIndex> links_of_contact(std::size_t k) const;
  void add_joint_forces(const State& state);
  bool needs_velocity_gradient(const MatrixWeights& weights) const;
  void linearise_forces(const MatrixWeights& weights, Linearisation& out) const;
  void linearise_contacts(const MatrixWeights& weights, Linearisation& out) const;
  void linearise_closures(const MatrixWeights& weights, ForceDerivatives& to, Linearisation& out) const;
  void linearise_sizes(const MatrixWeights& weights, Linearisation& out) const;

  const Model& model_;
  std::vector<LinkMotion> links_;
  std::vector<Load> loads_;  // (links)
  // Change of the applied loads per displacement of the link, less their rotation with it; valid where a
  // load is applied (links).
  std::vector<Matrix6d> applied_;
  std::vector<std::unique_ptr<ForceElement>> forces_;  // copies of those of the model (forces)
  std::vector<std::size_t> matrix_order_;              // see order_in_matrix() (forces)
  // Points in contact at the last residual(), and their pairs of moving links, sorted.
  std::vector<ContactPoint> contacts_;
  std::vector<std::pair<LinkIndex, LinkIndex>> moving_contacts_;
  VectorXd z_, zdot_;                         // (first-order states)
  std::vector<EquationValue> equations_;      // (equations)
  VectorXd phi_[3];                           // by level (equations)
  VectorXd lambda_;                           // of the last residual() (equations)
  double kinetic_energy_ = 0;                 // [J]
  VectorXd residual_;                         // (freedoms)
  VectorXd joint_stiffness_, joint_damping_;  // of the forces on single coordinates (freedoms)
  VectorXd rotors_;  // inertia of the motors' rotors on the coordinates (freedoms); empty: there are none
};

}  // namespace tandem::mbd
