// Force elements: springs, bushings, ropes, loads, motors, cylinders, tyres. The dynamics, their
// linearisation, the balance of energy and the observers iterate over Model::forces by this interface and
// know no kind.
//
// A kind of element is a file of this folder: its data, its class, and a function make_force() that
// setup/place_forces.cpp calls. The order of Model::forces is that of all sums, so that equal scenes give
// equal bits (find_order_of_forces() in setup/place_forces.cpp).
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "mbd_server/forces/channel_values.hpp"
#include "mbd_server/forces/energy_port.hpp"
#include "mbd_server/forces/force_derivatives.hpp"
#include "mbd_server/forces/instant.hpp"

namespace tandem::mbd {

// Takes the forces of elements on bodies.
class ForceReceiver {
 public:
  virtual ~ForceReceiver() = default;
  // Force and torque at point p, of constant direction in the world [N], [N m].
  virtual void at_point(const PointOnBody& on, const Vector3d& p, const Vector3d& force,
                        const Vector3d& torque) = 0;
  // The same, which rotates with the body.
  virtual void following(const PointOnBody& on, const Vector3d& p, const Vector3d& force,
                         const Vector3d& torque) = 0;
  // A wrench that is constant in the world.
  virtual void wrench(const PointOnBody& on, const Vector6d& wrench) = 0;
};

// Sums over single coordinates (freedoms).
struct CoordinateSums {
  VectorXd &residual, &stiffness, &damping;
  double& kinetic_energy;
};

// Where an element is in the order of sums: of the forces, and of the iteration matrix.
struct OrderOfForce {
  int forces = 0, matrix = 0;
};

class ForceElement {
 public:
  explicit ForceElement(int account, OrderOfForce order) : account_(account), order_(order) {}
  virtual ~ForceElement() = default;
  // Dynamics evaluates copies of its own.
  virtual std::unique_ptr<ForceElement> clone() const = 0;
  int account() const { return account_; }  // see Model::accounts
  OrderOfForce order() const { return order_; }

  // ---- what it is
  // Whether it loses energy, and whether it does work that it has not stored.
  virtual bool dissipates() const { return false; }
  virtual bool gives_energy() const { return false; }
  // The size of its force where that is a function of a joint coordinate.
  virtual const SizeOverJoint* over() const { return nullptr; }
  // Of a motor: link whose coordinate it drives, and the inertia of its rotor there.
  virtual LinkIndex coordinate() const { return none; }
  virtual double rotor() const { return 0; }

  // ---- forces; evaluate() keeps them for the functions below
  virtual void evaluate(const Instant& at) = 0;
  virtual void add_forces(ForceReceiver& to) const = 0;
  // States of first order and their rates (first-order states).
  virtual void write_states(VectorXd& /*z*/, VectorXd& /*rates*/) const {}
  // Forces on single coordinates.
  virtual void add_to_coordinates(const Instant&, CoordinateSums&) const {}

  // ---- derivatives: connect() once, its result for each linearise()
  virtual std::vector<int> connect(const Model& model, ForceConnections& to) const = 0;
  virtual void linearise(const std::vector<int>& connections, ForceDerivatives& to) const = 0;

  // ---- energy and results; these do not depend on evaluate()
  virtual double stored_energy(const Instant&) const { return 0; }
  // The element's part in the balance of energy; null: it neither loses nor gives energy.
  virtual std::unique_ptr<EnergyPort> energy_port() const { return nullptr; }
  virtual void observe(const Instant& at, ChannelValues& to) const = 0;
  virtual ForceSize size(const Instant& at) const = 0;
  // What it pulls against a coordinate that a motion prescribes.
  virtual double pull_on(LinkIndex /*coordinate*/, const Instant&) const { return 0; }

 private:
  int account_;
  OrderOfForce order_;
};

// An element with these data.
template <class Data>
class ForceOf : public ForceElement {
 public:
  ForceOf(Data given, OrderOfForce order) : ForceElement(given.account, order), data(std::move(given)) {}
  const Data data;
};

// The class of a kind derives from this: `Own` is the class itself.
template <class Own, class Data>
class KindOfForce : public ForceOf<Data> {
 public:
  using ForceOf<Data>::ForceOf;
  std::unique_ptr<ForceElement> clone() const override {
    return std::make_unique<Own>(static_cast<const Own&>(*this));
  }
};

// The elements with these data, in their order.
template <class Data>
std::vector<const Data*> forces_of(const Model& model) {
  std::vector<const Data*> found;
  for (const auto& force : model.forces)
    if (const auto* of = dynamic_cast<const ForceOf<Data>*>(force.get())) found.push_back(&of->data);
  return found;
}

}  // namespace tandem::mbd
