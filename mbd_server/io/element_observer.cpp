#include "mbd_server/io/element_observer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/forces/bushing.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/forces/rope.hpp"
#include "mbd_server/forces/size_over_joint.hpp"
#include "mbd_server/forces/spring_damper.hpp"
#include "mbd_server/forces/tyre.hpp"
#include "mbd_server/io/energy_balance.hpp"

namespace tandem::mbd {

using scene::Channel;

// The row that is being filled in.
class ElementObserver::Values {
 public:
  Values(const std::vector<Account>& accounts, std::vector<double>& row) : accounts_(accounts), row_(row) {}

  // Adds to the column, where the element has it.
  void add(int account, Channel channel, double value, int part = 0) {
    const int first = accounts_[static_cast<std::size_t>(account)].first[static_cast<std::size_t>(channel)];
    if (first != none) row_[static_cast<std::size_t>(first + part)] += value;
  }
  // A force or torque on a coordinate and its rate.
  void add_effort(int account, bool rotates, double effort, double rate) {
    add(account, rotates ? Channel::torque : Channel::force, effort);
    add(account, rotates ? Channel::speed : Channel::velocity, rate);
    add(account, Channel::power, effort * rate);
  }

 private:
  const std::vector<Account>& accounts_;
  std::vector<double>& row_;
};

ElementObserver::ElementObserver(const Model& model, const std::vector<scene::ElementOfScene>& elements)
    : model_(model), accounts_(elements.size()), stored_at_start_(model.elements.size(), 0.0) {
  for (std::size_t a = 0; a < elements.size(); ++a) {
    accounts_[a].first.fill(none);
    accounts_[a].is_force = elements[a].source == scene::ElementOfScene::Source::force;
    for (const scene::ElementColumn& column : elements[a].columns) {
      int& first = accounts_[a].first[static_cast<std::size_t>(column.channel)];
      // The parts of a channel follow each other. Those of a coupler, force or torque on each of its joints,
      // are counted together.
      if (first == none) first = static_cast<int>(columns_) - column.part;
      ++columns_;
    }
  }
}

void ElementObserver::start(const State& state, const MachineSystem& system) {
  for (std::size_t i = 0; i < model_.elements.size(); ++i) {
    const Element& e = model_.elements[i];
    stored_at_start_[i] = stored_energy(e, argument(e, system.links()).s, states_of(e, state.z));
  }
}

void ElementObserver::observe(const State& state, const MachineSystem& system, const EnergySums& sums,
                              std::vector<double>& row) const {
  row.assign(columns_, 0);
  if (accounts_.empty()) return;
  Values values(accounts_, row);
  for (std::size_t a = 0; a < accounts_.size(); ++a) {
    values.add(static_cast<int>(a), Channel::energy, sums.work_of[a]);
    values.add(static_cast<int>(a), Channel::supply_energy, sums.work_of[a]);
    values.add(static_cast<int>(a), Channel::loss_energy, sums.lost_of[a]);
  }
  observe_joints(state, system, values);
  observe_joint_forces(state, system, values);
  observe_couplers(state, system, values);
  observe_elements(state, system, sums, values);
  observe_springs(system, values);
  observe_tyres(state, system, values);
  observe_loads(state, system, values);
  observe_contacts(state, system, values);
}

void ElementObserver::observe_joints(const State& state, const MachineSystem& system, Values& values) const {
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    const Link& link = model_.links[i];
    if (link.account == none) continue;
    const auto at = static_cast<LinkIndex>(i);
    values.add_effort(link.account, rotates(link.kind), effort_of_motion(model_, at, state, system),
                      system.links()[i].coordinate.rate);
  }
}

void ElementObserver::observe_joint_forces(const State& state, const MachineSystem& system,
                                           Values& values) const {
  for (const JointForce& f : model_.joint_forces) {
    if (f.account == none) continue;
    const Link& link = model_.links[f.link];
    const CoordinateMotion& c = system.links()[f.link].coordinate;
    const bool single = freedoms(link.kind) == 1;
    for (int k = 0; k < freedoms(link.kind); ++k)
      values.add(f.account, Channel::loss_power,
                 dissipated_power(f, state.stops, friction_share(f, model_, state), single ? c.value : 0,
                                  single ? c.rate : state.u[link.u + k]));
    if (f.brake) {
      // What holds a coordinate that sticks is its residual, which has no friction then.
      const bool sticks = f.stiction != none && state.sliding.size() > 0 && state.sliding[f.stiction] == 0;
      values.add(f.account, Channel::brake_torque,
                 sticks ? system.last_residual()[link.u] : evaluate(f, model_, state, c.value, c.rate).force);
      continue;
    }
    if (!accounts_[static_cast<std::size_t>(f.account)].is_force) continue;
    values.add_effort(f.account, rotates(link.kind), evaluate(f, model_, state, c.value, c.rate).force,
                      c.rate);
    values.add(f.account, Channel::stored_energy, energy(f, c.value));
  }
}

// The multiplier of a coupler acts on each coordinate by the coordinate's factor in its equation.
void ElementObserver::observe_couplers(const State& state, const MachineSystem& system,
                                       Values& values) const {
  for (const Closure& c : model_.closures) {
    if (c.account == none) continue;
    const EquationValue& equation = system.equations()[static_cast<std::size_t>(c.first)];
    const auto add = [&](LinkIndex link, int part) {
      const double effort = -on_coordinate(c, equation, link) * state.lambda[c.first];
      values.add(c.account, rotates(model_.links[link].kind) ? Channel::torque : Channel::force, effort,
                 part);
      if (part == 0) values.add(c.account, Channel::power, -effort * system.links()[link].coordinate.rate);
    };
    if (c.terms.empty()) add(c.a, 0), add(c.b, 1);
    for (std::size_t k = 0; k < c.terms.size(); ++k) add(c.terms[k].link, static_cast<int>(k));
  }
}

// What a cylinder gives the machine is what comes in, less what it dissipates and stores.
void ElementObserver::observe_elements(const State& state, const MachineSystem& system,
                                       const EnergySums& sums, Values& values) const {
  for (std::size_t i = 0; i < model_.elements.size(); ++i) {
    const Element& e = model_.elements[i];
    const int a = e.account;
    const ElementArgument x = argument(e, system.links());
    const StatesOfElement z = states_of(e, state.z);
    const ElementValue value = evaluate(e, model_, state, x.s, x.v);
    const ElementPower power = mbd::power(e, model_, state, x, z);
    values.add(a, Channel::loss_power, power.lost);
    const double signal = signal_of(e, model_, state);
    for (const Channel channel : {Channel::target_speed, Channel::target_angle, Channel::target_stroke,
                                  Channel::throttle, Channel::opening})
      values.add(a, channel, signal);
    if (!e.is_cylinder()) {
      values.add_effort(a, true, value.force - value.passive, x.v);
      values.add(a, Channel::brake_torque, value.passive);
      continue;
    }
    const double stored = stored_energy(e, x.s, z);
    values.add_effort(a, false, value.force, x.v);
    values.add(a, Channel::energy,
               -sums.lost_of[static_cast<std::size_t>(a)] - (stored - stored_at_start_[i]));
    values.add(a, Channel::stroke, x.s);
    values.add(a, Channel::stored_energy, stored);
    values.add(a, Channel::supply_power, power.work);
    values.add(a, Channel::pressure_a, z[0]);
    values.add(a, Channel::pressure_b, z[1]);
    const ChamberFlows flows = valve_flows(e, model_, state, z);
    values.add(a, Channel::flow_a, flows.a);
    values.add(a, Channel::flow_b, flows.b);
  }
}

void ElementObserver::observe_springs(const MachineSystem& system, Values& values) const {
  const std::vector<LinkMotion>& links = system.links();
  for (const Spring& spring : model_.springs) {
    if (spring.account == none) continue;
    const Line line = line_between(spring.a, spring.b, links);
    const double rate = line.rate(), damper = spring.viscous.at(rate).force,
                 tension = spring.elastic.at(line.length - spring.length).force + damper;
    values.add(spring.account, Channel::force, tension);
    values.add(spring.account, Channel::length, line.length);
    values.add(spring.account, Channel::velocity, rate);
    values.add(spring.account, Channel::power, -tension * rate);
    values.add(spring.account, Channel::stored_energy, spring.elastic.energy(line.length - spring.length));
    values.add(spring.account, Channel::loss_power, damper * rate);
  }
  for (const BushingOnLinks& bushing : model_.bushings) {
    if (bushing.account == none) continue;
    const BushingForce f = evaluate(bushing, links);
    const LinkMotion &a = links[bushing.a.link], &b = links[bushing.b.link];
    const Vector6d V = b.V - a.V;
    const Vector3d v = at_point(V, f.p), w = V.head<3>(), force = f.on_b.head<3>(), torque = f.on_b.tail<3>();
    const Vector3d force_a = a.R_WL.transpose() * force, torque_a = a.R_WL.transpose() * torque;
    for (int axis = 0; axis < 3; ++axis) {
      values.add(bushing.account, Channel::force, force_a[axis], axis);
      values.add(bushing.account, Channel::torque, torque_a[axis], axis);
    }
    Vector6d rate;
    rate << a.R_WL.transpose() * v, a.R_WL.transpose() * w;
    values.add(bushing.account, Channel::power, force.dot(v) + torque.dot(w));
    values.add(bushing.account, Channel::stored_energy, f.energy);
    values.add(bushing.account, Channel::loss_power, rate.dot(bushing.damping * rate));
  }
  for (const RopeOnLinks& rope : model_.ropes) {
    if (rope.account == none) continue;
    const RopeStretch stretch = stretch_of(rope, links);
    const double pull = tension(rope, stretch.elongation, stretch.rate),
                 e = std::max(0.0, stretch.elongation);
    values.add(rope.account, Channel::tension, pull);
    values.add(rope.account, Channel::length, rope.length + stretch.elongation);
    values.add(rope.account, Channel::slack, std::max(0.0, -stretch.elongation));
    values.add(rope.account, Channel::power, -pull * stretch.rate);
    values.add(rope.account, Channel::stored_energy, 0.5 * rope.stiffness * e * e);
    values.add(rope.account, Channel::loss_power, dissipated_power(rope, stretch.elongation, stretch.rate));
  }
}

void ElementObserver::observe_tyres(const State& state, const MachineSystem& system, Values& values) const {
  for (const TyreOnLink& tyre : model_.tyres) {
    if (tyre.account == none) continue;
    const TyreForce f = evaluate(tyre, state, system.links());
    for (int axis = 0; axis < 3; ++axis) values.add(tyre.account, Channel::force, f.force[axis], axis);
    values.add(tyre.account, Channel::slip, f.slip.x());
    values.add(tyre.account, Channel::slip_angle, std::atan(f.slip.y()));
    values.add(tyre.account, Channel::aligning_torque, f.aligning);
    values.add(tyre.account, Channel::loaded_radius, f.radius);
    values.add(tyre.account, Channel::power, f.power);
    values.add(tyre.account, Channel::stored_energy, f.energy);
    values.add(tyre.account, Channel::loss_power, f.lost);
  }
}

void ElementObserver::observe_loads(const State& state, const MachineSystem& system, Values& values) const {
  const std::vector<LinkMotion>& links = system.links();
  for (const LoadOnLink& load : model_.loads) {
    if (load.account == none) continue;
    const LinkMotion& link = links[load.at.link];
    const double size = size_of(load, state, links);
    const Vector3d direction = load.follows ? Vector3d(link.R_WL * load.direction) : load.direction;
    const Vector3d rate = load.torque ? Vector3d(link.V.head<3>()) : link.velocity(link.point(load.at.p_LP));
    values.add(load.account, load.torque ? Channel::torque : Channel::force, size);
    values.add(load.account, Channel::power, size * direction.dot(rate));
  }
}

void ElementObserver::observe_contacts(const State& state, const MachineSystem& system,
                                       Values& values) const {
  const BodyContactModel& contact = model_.contact;
  if (contact.outputs.empty()) return;
  const std::vector<LinkMotion>& links = system.links();
  contacts_.assign(contact.outputs.size(), {});
  for (const ContactPoint& point : state.contacts) {
    const int a = point.feature.a, b = point.feature.b;
    std::optional<ContactForce> f;
    contact.for_each_output(a, b, [&](int i, double sign) {
      if (!f) f = evaluate(model_, point, links, Derivatives::without);
      OfContacts& sum = contacts_[static_cast<std::size_t>(i)];
      sum.force += sign * f->force, sum.friction += sign * f->friction;
      sum.torque += sign * wrench_at(f->p, f->force, f->torque).head<3>();
      sum.moment += f->normal * f->p;
      sum.normal += f->normal, sum.depth = std::max(sum.depth, -f->gap), sum.points += f->gap <= 0;
      sum.power += f->power(), sum.energy += f->energy;
    });
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const ContactOutput& output = contact.outputs[i];
    const OfContacts& sum = contacts_[i];
    // Positions in the model are relative to its origin.
    Vector3d about = -model_.origin, centre = Vector3d::Zero();
    if (output.body != none) {
      const BodyOnLink& body = model_.bodies[output.body];
      about = links[body.link].point(body.p_LB);
    }
    if (sum.normal > 0) centre = model_.origin + sum.moment / sum.normal;
    const Vector3d torque = sum.torque - about.cross(sum.force);
    for (int axis = 0; axis < 3; ++axis) {
      values.add(output.account, Channel::force, sum.force[axis], axis);
      values.add(output.account, Channel::torque, torque[axis], axis);
      values.add(output.account, Channel::friction, sum.friction[axis], axis);
      values.add(output.account, Channel::centre, centre[axis], axis);
    }
    values.add(output.account, Channel::normal_force, sum.normal);
    values.add(output.account, Channel::depth, sum.depth);
    values.add(output.account, Channel::points, sum.points);
    values.add(output.account, Channel::power, sum.power);
    values.add(output.account, Channel::stored_energy, sum.energy);
  }
}

}  // namespace tandem::mbd
