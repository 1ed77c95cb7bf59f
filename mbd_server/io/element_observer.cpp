#include "mbd_server/io/element_observer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/io/energy_balance.hpp"

namespace tandem::mbd {

using scene::Channel;

ElementObserver::ElementObserver(const Model& model, const std::vector<scene::ElementOfScene>& elements)
    : model_(model), accounts_(elements.size()), stored_at_start_(model.forces.size(), 0.0) {
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
  for (std::size_t f = 0; f < model_.forces.size(); ++f)
    stored_at_start_[f] = model_.forces[f]->stored_energy({model_, state, system.links()});
}

void ElementObserver::observe(const State& state, const MachineSystem& system, const EnergySums& sums,
                              std::vector<double>& row) const {
  row.assign(columns_, 0);
  if (accounts_.empty()) return;
  ChannelValues values(accounts_, sums, row);
  for (std::size_t a = 0; a < accounts_.size(); ++a) {
    values.add(static_cast<int>(a), Channel::energy, sums.work_of[a]);
    values.add(static_cast<int>(a), Channel::supply_energy, sums.work_of[a]);
    values.add(static_cast<int>(a), Channel::loss_energy, sums.lost_of[a]);
  }
  observe_joints(state, system, values);
  observe_joint_forces(state, system, values);
  observe_couplers(state, system, values);
  for (std::size_t f = 0; f < model_.forces.size(); ++f) {
    if (model_.forces[f]->account() == none) continue;
    values.stored_at_start = stored_at_start_[f];
    model_.forces[f]->observe({model_, state, system.links()}, values);
  }
  observe_contacts(state, system, values);
}

void ElementObserver::observe_joints(const State& state, const MachineSystem& system,
                                     ChannelValues& values) const {
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    const Link& link = model_.links[i];
    if (link.account == none) continue;
    const auto at = static_cast<LinkIndex>(i);
    values.add_effort(link.account, rotates(link.kind), effort_of_motion(model_, at, state, system),
                      system.links()[i].coordinate.rate);
  }
}

void ElementObserver::observe_joint_forces(const State& state, const MachineSystem& system,
                                           ChannelValues& values) const {
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
    if (!values.is_force(f.account)) continue;
    values.add_effort(f.account, rotates(link.kind), evaluate(f, model_, state, c.value, c.rate).force,
                      c.rate);
    values.add(f.account, Channel::stored_energy, energy(f, c.value));
  }
}

// The multiplier of a coupler acts on each coordinate by the coordinate's factor in its equation.
void ElementObserver::observe_couplers(const State& state, const MachineSystem& system,
                                       ChannelValues& values) const {
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

void ElementObserver::observe_contacts(const State& state, const MachineSystem& system,
                                       ChannelValues& values) const {
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
