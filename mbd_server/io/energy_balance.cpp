#include "mbd_server/io/energy_balance.hpp"

#include <algorithm>

#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/forces/size_over_joint.hpp"

namespace tandem::mbd {
// Inverse dynamics of the coordinate: the effort that moves everything outboard, less the other forces on the
// joint.
double effort_of_motion(const Model& model, LinkIndex i, const State& state, const MachineSystem& system) {
  const CoordinateMotion& c = system.links()[i].coordinate;
  double effort = system.links()[i].S.col(0).dot(system.transmitted(i));
  for (const JointForce& force : model.joint_forces)
    if (force.link == i) effort -= evaluate(force, model, state, c.value, c.rate).force;
  for (const auto& force : model.forces) effort += force->pull_on(i, {model, state, system.links()});
  for (const Closure& closure : model.closures) {
    if (!closure.is_coupler()) continue;
    const EquationValue& e = system.equations()[static_cast<std::size_t>(closure.first)];
    effort += on_coordinate(closure, e, i) * state.lambda[closure.first];
  }
  return effort;
}

EnergyBalance::EnergyBalance(const Model& model) : model_(model) {
  for (const auto& force : model.forces)
    if (auto port = force->energy_port()) forces_.push_back(std::move(port));
  for (const JointForce& force : model.joint_forces)
    if (force.drive != none || force.input != none || force.over || dissipates(force))
      joints_.push_back({.force = &force, .dissipates = dissipates(force)});
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (model.links[i].motion != none) motions_.push_back({.link = static_cast<LinkIndex>(i)});
}

void EnergyBalance::begin(const State& state, const MachineSystem& system) {
  time_ = state.time;
  contacts_ = state.stops;
  between_.inputs = state.inputs;
  for (const auto& force : forces_) force->begin({model_, state, system.links()});
  for (JointPort& port : joints_) port = at(port, state, system);
  for (MotionPort& port : motions_) port = at(port, state, system);
}

void EnergyBalance::add_step(const State& state, const MachineSystem& system, double h, bool sudden,
                             EnergySums& sums) {
  sudden_ = sudden;
  // The state has lost a contact that ends with the step, and did not have one that began with it.
  for (Eigen::Index i = 0; i < contacts_.cols(); ++i)
    if (contacts_(StopRow::entry_rate, i) == 0) contacts_.col(i) = state.stops.col(i);
  between_.time = time_ + 0.5 * h, between_.side = time_;
  const EnergyStep step{model_, time_, h, sudden, between_};
  for (const auto& force : forces_) force->add_step({model_, state, system.links()}, step, sums);
  const auto add_all = [&](auto& ports) {
    for (auto& port : ports) {
      const auto now = at(port, state, system);
      add(port, now, h, sums);
      port = now;
    }
  };
  add_all(joints_), add_all(motions_);
  sums.largest_kinetic = std::max(sums.largest_kinetic, system.kinetic_energy());
  time_ = state.time;
  contacts_ = state.stops;
}

// ---- joints

EnergyBalance::Coordinates EnergyBalance::coordinates(LinkIndex i, const State& state,
                                                      const MachineSystem& system) const {
  const Link& link = model_.links[i];
  Coordinates c{};
  if (freedoms(link.kind) == 1) {  // prescribed coordinates are not in the state
    c.q[0] = system.links()[i].coordinate.value;
    c.u[0] = system.links()[i].coordinate.rate;
    c.udot[0] = link.motion == none ? state.udot[link.u] : system.links()[i].coordinate.acceleration;
    return c;
  }
  std::copy_n(&state.q[link.q], mbd::coordinates(link.kind), c.q.begin());
  std::copy_n(&state.u[link.u], 3, c.u.begin());
  std::copy_n(&state.udot[link.u], 3, c.udot.begin());
  return c;
}

// Integral of the rates.
std::array<double, 3> EnergyBalance::displacement(LinkIndex i, const Coordinates& from, const Coordinates& to,
                                                  double h) const {
  const Link& link = model_.links[i];
  std::array<double, 3> x{};
  difference(link.kind, from.q.data(), to.q.data(), x.data());
  if (link.kind == Elementary::spherical) {  // as in integrated_rate(); outboard axes change the sign
    Eigen::Map<Vector3d> sum(x.data());
    sum -= h * h / 12 * Vector3d(from.u.data()).cross(Vector3d(to.u.data()));
  }
  return x;
}

EnergyBalance::JointPort EnergyBalance::at(const JointPort& port, const State& state,
                                           const MachineSystem& system) const {
  const JointForce& force = *port.force;
  const int n = freedoms(model_.links[force.link].kind);
  JointPort now{.force = port.force, .dissipates = port.dissipates};
  now.at = coordinates(force.link, state, system);
  if (port.dissipates) {
    const double share = friction_share(force, model_, state);
    for (int k = 0; k < n; ++k)
      now.lost[k] = dissipated_power(force, state.stops, share, n == 1 ? now.at.q[0] : 0, now.at.u[k]);
  }
  if (force.drive != none) now.drive = model_.drives[force.drive].at(state.time, state.side).value;
  if (force.input != none) now.drive = state.inputs[force.input];
  if (force.over) {
    now.over = system.links()[force.over->link].coordinate;
    now.drive = size_over(*force.over, now.over).value;
  }
  return now;
}

void EnergyBalance::add(const JointPort& from, const JointPort& to, double h, EnergySums& sums) const {
  const JointForce& force = *to.force;
  const int n = freedoms(model_.links[force.link].kind);
  const auto moved = displacement(force.link, from.at, to.at, h);
  for (int k = 0; k < n; ++k) {
    const double v0 = from.at.u[k], v1 = to.at.u[k],
                 rate = middle_rate(sudden_, moved[k], v0, v1, from.at.udot[k], to.at.udot[k], h);
    if (to.dissipates) {
      const double q = n == 1 ? middle(from.at.q[0], to.at.q[0], v0, v1, h) : 0;
      const double share = friction_share(force, model_, between_);
      sums.add(&EnergySums::dissipated,
               simpson(from.lost[k], dissipated_power(force, contacts_, share, q, rate), to.lost[k], h),
               force.account);
    }
    if (force.drive != none) {
      const double between = model_.drives[force.drive].at(time_ + 0.5 * h, time_).value;
      sums.add(&EnergySums::actuator_work, simpson(from.drive * v0, between * rate, to.drive * v1, h),
               force.account);
    }
    if (force.input != none) sums.add(&EnergySums::actuator_work, to.drive * moved[k], force.account);
    if (force.over) {
      const double between = size_over(*force.over, between_of(from.over, to.over, h)).value;
      sums.add(&EnergySums::actuator_work, simpson(from.drive * v0, between * rate, to.drive * v1, h),
               force.account);
    }
  }
}

EnergyBalance::MotionPort EnergyBalance::at(const MotionPort& port, const State& state,
                                            const MachineSystem& system) const {
  MotionPort now{.link = port.link};
  now.at = coordinates(port.link, state, system);
  now.effort = effort_of_motion(model_, port.link, state, system);
  return now;
}

void EnergyBalance::add(const MotionPort& from, const MotionPort& to, double h, EnergySums& sums) const {
  const double v0 = from.at.u[0], v1 = to.at.u[0];
  const double rate = middle_rate(to.at.q[0] - from.at.q[0], v0, v1, h);
  const double between = 0.5 * (from.effort + to.effort) * rate;
  sums.add(&EnergySums::motion_work, simpson(from.effort * v0, between, to.effort * v1, h),
           model_.links[to.link].account);
}

}  // namespace tandem::mbd
