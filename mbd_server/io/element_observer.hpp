// Results over time of the elements of a scene: the values of scene::element_columns() at a state.
#pragma once

#include <vector>

#include "common/scene/element_columns.hpp"
#include "mbd_server/io/run_totals.hpp"
#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

class ElementObserver {
 public:
  // The model must outlive this object; `elements` are those of its scene.
  ElementObserver(const Model& model, const std::vector<scene::ElementOfScene>& elements);

  // Call in the state at the start of the run: the energy that elements store there is not counted as given.
  void start(const State& state, const MachineSystem& system);
  // One value for each column. Both functions assume the state of the last residual(). Costs nothing for a
  // machine without elements.
  void observe(const State& state, const MachineSystem& system, const EnergySums& sums,
               std::vector<double>& values) const;

 private:
  void observe_joints(const State& state, const MachineSystem& system, ChannelValues& values) const;
  void observe_joint_forces(const State& state, const MachineSystem& system, ChannelValues& values) const;
  void observe_couplers(const State& state, const MachineSystem& system, ChannelValues& values) const;
  void observe_contacts(const State& state, const MachineSystem& system, ChannelValues& values) const;

  // What the points of one output do together at an instant.
  struct OfContacts {
    Vector3d force = Vector3d::Zero(), friction = force, torque = force, moment = force;  // N times point
    double normal = 0, depth = 0, points = 0, power = 0, energy = 0;
  };
  const Model& model_;
  std::size_t columns_ = 0;
  std::vector<ElementAccount> accounts_;
  mutable std::vector<OfContacts> contacts_;  // (outputs of contacts)
  std::vector<double> stored_at_start_;       // (forces of the model) [J]
};

}  // namespace tandem::mbd
