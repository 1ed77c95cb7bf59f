#include "mbd_server/io/energy_balance.hpp"

#include <algorithm>

#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/forces/size_over_joint.hpp"
#include "mbd_server/forces/tyre.hpp"

namespace tandem::mbd {
namespace {

// Rate in the middle of a step, from the cubic through the displacement `moved` and the rates v0 and v1.
template <class Value>
Value middle_rate(const Value& moved, const Value& v0, const Value& v1, double h) {
  return 1.5 / h * moved - 0.25 * (v0 + v1);
}

// Value in the middle of a step, from the cubic.
template <class Value>
Value middle(const Value& x0, const Value& x1, const Value& v0, const Value& v1, double h) {
  return 0.5 * (x0 + x1) + h / 8 * (v0 - v1);
}

double product(double a, double b) {
  return a * b;
}
double product(const Vector3d& a, const Vector3d& b) {
  return a.dot(b);
}

// The same where the accelerations a0 and a1 are known, in a step that is `sudden`.
template <class Value>
Value middle_rate(bool sudden, const Value& moved, const Value& v0, const Value& v1, const Value& a0,
                  const Value& a1, double h) {
  constexpr double round_off = 1e-3;
  const bool keeps = product(a0, a1) >= -round_off * (product(a0, a0) + product(a1, a1));
  return sudden && keeps ? middle(v0, v1, a0, a1, h) : middle_rate(moved, v0, v1, h);
}

double simpson(double begin, double middle, double end, double h) {
  return h / 6 * (begin + 4 * middle + end);
}

// A coordinate and its rate in the middle of a step.
CoordinateMotion between_of(const CoordinateMotion& from, const CoordinateMotion& to, double h) {
  return {middle(from.value, to.value, from.rate, to.rate, h),
          middle_rate(to.value - from.value, from.rate, to.rate, h), 0};
}

// Integral of the angular velocity over a step from orientation q0 to q1, in the axes of both rates: the
// rotation vector, plus the first term of the series of [Magnus1954] for rotations about different axes.
Vector3d integrated_rate(const Quaterniond& q0, const Quaterniond& q1, const Vector3d& w0, const Vector3d& w1,
                         double h) {
  return to_eigen(rotation_vector(to_quat(q1 * q0.conjugate()))) + h * h / 12 * w0.cross(w1);
}

double dissipated(const Spring& spring, double rate) {
  return spring.viscous.at(rate).force * rate;
}

double dissipated(const BushingOnLinks& bushing, const Vector6d& rate) {
  return rate.dot(bushing.damping * rate);
}

}  // namespace

// Inverse dynamics of the coordinate: the effort that moves everything outboard, less the other forces on the
// joint.
double effort_of_motion(const Model& model, LinkIndex i, const State& state, const MachineSystem& system) {
  const CoordinateMotion& c = system.links()[i].coordinate;
  double effort = system.links()[i].S.col(0).dot(system.transmitted(i));
  for (const JointForce& force : model.joint_forces)
    if (force.link == i) effort -= evaluate(force, model, state, c.value, c.rate).force;
  for (const RopeOnLinks& rope : model.ropes) {
    if (rope.drum != i) continue;
    const RopeStretch stretch = stretch_of(rope, system.links());
    effort += rope.per_angle * tension(rope, stretch.elongation, stretch.rate);
  }
  for (const Closure& closure : model.closures) {
    if (!closure.is_coupler()) continue;
    const EquationValue& e = system.equations()[static_cast<std::size_t>(closure.first)];
    effort += on_coordinate(closure, e, i) * state.lambda[closure.first];
  }
  return effort;
}

EnergyBalance::EnergyBalance(const Model& model) : model_(model) {
  for (const LoadOnLink& load : model.loads)
    if (load.at.link != 0) loads_.push_back({.load = &load});
  for (const JointForce& force : model.joint_forces)
    if (force.drive != none || force.input != none || force.over || dissipates(force))
      joints_.push_back({.force = &force, .dissipates = dissipates(force)});
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (model.links[i].motion != none) motions_.push_back({.link = static_cast<LinkIndex>(i)});
  for (const Spring& spring : model.springs)
    if (spring.viscous.present()) springs_.push_back({.spring = &spring});
  for (const BushingOnLinks& bushing : model.bushings)
    if (!bushing.damping.isZero(0)) bushings_.push_back({.bushing = &bushing});
  for (const RopeOnLinks& rope : model.ropes)
    if (rope.damping != 0) ropes_.push_back({.rope = &rope});
  for (const TyreOnLink& tyre : model.tyres) tyres_.push_back({.tyre = &tyre});
  for (const Element& element : model.elements) elements_.push_back({.element = &element});
}

void EnergyBalance::begin(const State& state, const MachineSystem& system) {
  time_ = state.time;
  contacts_ = state.stops;
  if (!elements_.empty()) between_.inputs = state.inputs;
  for_each_list([&](auto& ports) {
    for (auto& port : ports) port = seen(port, state, system);
  });
}

void EnergyBalance::add_step(const State& state, const MachineSystem& system, double h, bool sudden,
                             EnergySums& sums) {
  sudden_ = sudden;
  // The state has lost a contact that ends with the step, and did not have one that began with it.
  for (Eigen::Index i = 0; i < contacts_.cols(); ++i)
    if (contacts_(StopRow::entry_rate, i) == 0) contacts_.col(i) = state.stops.col(i);
  for_each_list([&](auto& ports) {
    for (auto& port : ports) {
      const auto now = seen(port, state, system);
      add(port, now, h, sums);
      port = now;
    }
  });
  sums.largest_kinetic = std::max(sums.largest_kinetic, system.kinetic_energy());
  time_ = state.time;
  contacts_ = state.stops;
}

// ---- forces and torques of the scene

EnergyBalance::LoadPort EnergyBalance::seen(const LoadPort& port, const State& state,
                                            const MachineSystem& system) const {
  const LoadOnLink& load = *port.load;
  const LinkMotion& link = system.links()[load.at.link];
  const Vector3d w = link.V.head<3>();
  LoadPort now{.load = port.load};
  now.point = link.point(load.at.p_LP);
  now.orientation = link.q_WL;
  now.rate = load.torque ? w : link.velocity(now.point);
  now.acceleration = link.A.head<3>();
  if (!load.torque) now.acceleration = at_point(link.A, now.point) + w.cross(now.rate) + model_.gravity;
  now.direction = load.direction;
  if (load.follows) {
    now.direction = link.R_WL * load.direction;
    now.direction_rate = w.cross(now.direction);
  }
  now.power = size_of(load, state, system.links()) * now.direction.dot(now.rate);
  if (load.over) now.over = system.links()[load.over->link].coordinate;
  return now;
}

void EnergyBalance::add(const LoadPort& from, const LoadPort& to, double h, EnergySums& sums) const {
  const Vector3d moved = to.load->torque
                             ? integrated_rate(from.orientation, to.orientation, from.rate, to.rate, h)
                             : Vector3d(to.point - from.point);
  const Vector3d rate =
      middle_rate(sudden_, moved, from.rate, to.rate, from.acceleration, to.acceleration, h);
  const Vector3d direction = middle(from.direction, to.direction, from.direction_rate, to.direction_rate, h);
  const double size = to.load->over ? size_over(*to.load->over, between_of(from.over, to.over, h)).value
                                    : to.load->size.at(time_ + 0.5 * h, time_).value;
  const double between = size * direction.dot(rate);
  sums.add(&EnergySums::load_work, simpson(from.power, between, to.power, h), to.load->account);
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

EnergyBalance::JointPort EnergyBalance::seen(const JointPort& port, const State& state,
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
      between_.time = time_ + 0.5 * h, between_.side = time_;
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

EnergyBalance::MotionPort EnergyBalance::seen(const MotionPort& port, const State& state,
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

// ---- between points

EnergyBalance::SpringPort EnergyBalance::seen(const SpringPort& port, const State&,
                                              const MachineSystem& system) const {
  const Spring& spring = *port.spring;
  const LinkMotion &a = system.links()[spring.a.link], &b = system.links()[spring.b.link];
  const Vector3d p_a = a.point(spring.a.p_LP), p_b = b.point(spring.b.p_LP), r = p_b - p_a;
  SpringPort now{.spring = port.spring};
  now.length = r.norm();  // never zero, see evaluate()
  now.rate = r.dot(b.velocity(p_b) - a.velocity(p_a)) / now.length;
  now.lost = dissipated(spring, now.rate);
  return now;
}

void EnergyBalance::add(const SpringPort& from, const SpringPort& to, double h, EnergySums& sums) const {
  const double rate = middle_rate(to.length - from.length, from.rate, to.rate, h);
  sums.add(&EnergySums::dissipated, simpson(from.lost, dissipated(*to.spring, rate), to.lost, h),
           to.spring->account);
}

EnergyBalance::BushingPort EnergyBalance::seen(const BushingPort& port, const State&,
                                               const MachineSystem& system) const {
  const BushingOnLinks& bushing = *port.bushing;
  const LinkMotion &a = system.links()[bushing.a.link], &b = system.links()[bushing.b.link];
  const Vector3d p = b.point(bushing.b.p_LP);
  const Matrix3d R = a.R_WL.transpose();
  const Vector6d V = b.V - a.V;
  BushingPort now{.bushing = port.bushing};
  now.displacement = R * (p - a.point(bushing.a.p_LP));
  now.orientation = a.q_WL.conjugate() * b.q_WL;
  now.rate << R * at_point(V, p), R * V.head<3>();
  now.lost = dissipated(bushing, now.rate);
  return now;
}

void EnergyBalance::add(const BushingPort& from, const BushingPort& to, double h, EnergySums& sums) const {
  Vector6d moved;
  moved << to.displacement - from.displacement,
      integrated_rate(from.orientation, to.orientation, from.rate.tail<3>(), to.rate.tail<3>(), h);
  const Vector6d rate = middle_rate(moved, from.rate, to.rate, h);
  sums.add(&EnergySums::dissipated, simpson(from.lost, dissipated(*to.bushing, rate), to.lost, h),
           to.bushing->account);
}

// ---- ropes

EnergyBalance::RopePort EnergyBalance::seen(const RopePort& port, const State&,
                                            const MachineSystem& system) const {
  RopePort now{.rope = port.rope};
  const RopeStretch stretch = stretch_of(*port.rope, system.links());
  now.elongation = stretch.elongation, now.rate = stretch.rate;
  now.lost = dissipated_power(*port.rope, now.elongation, now.rate);
  return now;
}

void EnergyBalance::add(const RopePort& from, const RopePort& to, double h, EnergySums& sums) const {
  const double rate = middle_rate(to.elongation - from.elongation, from.rate, to.rate, h);
  const double elongation = middle(from.elongation, to.elongation, from.rate, to.rate, h);
  sums.add(&EnergySums::dissipated,
           simpson(from.lost, dissipated_power(*to.rope, elongation, rate), to.lost, h), to.rope->account);
}

// ---- tyres

EnergyBalance::TyrePort EnergyBalance::seen(const TyrePort& port, const State& state,
                                            const MachineSystem& system) const {
  return {.tyre = port.tyre, .lost = evaluate(*port.tyre, state, system.links()).lost};
}

// The power between the ends of a step is taken as linear.
void EnergyBalance::add(const TyrePort& from, const TyrePort& to, double h, EnergySums& sums) const {
  sums.add(&EnergySums::dissipated, 0.5 * h * (from.lost + to.lost), to.tyre->account);
}

// ---- motors and cylinders

EnergyBalance::ElementPort EnergyBalance::seen(const ElementPort& port, const State& state,
                                               const MachineSystem& system) const {
  const Element& e = *port.element;
  ElementPort now{.element = port.element};
  now.x = argument(e, system.links());
  now.z = states_of(e, state.z);
  now.power = power(e, model_, state, now.x, now.z);
  return now;
}

// States are linear in the middle of a step: a rate that the step does not resolve would make a cubic
// useless.
void EnergyBalance::add(const ElementPort& from, const ElementPort& to, double h, EnergySums& sums) const {
  between_.time = time_ + 0.5 * h;
  between_.side = time_;
  const ElementArgument x{middle(from.x.s, to.x.s, from.x.v, to.x.v, h),
                          middle_rate(to.x.s - from.x.s, from.x.v, to.x.v, h)};
  const ElementPower between =
      power(*to.element, model_, between_, x, StatesOfElement(0.5 * (from.z + to.z)));
  const int account = to.element->account;
  sums.add(&EnergySums::actuator_work, simpson(from.power.work, between.work, to.power.work, h), account);
  sums.add(&EnergySums::dissipated, simpson(from.power.lost, between.lost, to.power.lost, h), account);
}

}  // namespace tandem::mbd
