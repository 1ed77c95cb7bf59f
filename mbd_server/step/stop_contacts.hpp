// Contacts of joint coordinates with their stops. A stop is a stiff spring on one side: a step that does not
// end at the begin and at the end of a contact gives the coordinate an impulse that depends on the position
// of the step in time. So
//
// - a step that would pass the begin or the end of a contact is repeated so that it ends there; in between,
// each stop pushes or does not push, and the forces are smooth;
// - in a contact, and after it until the step has grown again, steps are a part of the contact's duration
//   T = pi sqrt(m / k), with m the inertia that the stop feels, 1 / m = e^T A^-1 e (Schwieger, with
//   closures);
// - the work of the accelerations along the coordinate gives the rate at which a contact ends,
//   u^2/2 = v^2/2 + sum (u'_0 + u'_1)/2 (q_1 - q_0):
//   the stop's spring returns its work, its damping dissipates. An impulse through the mass matrix removes
//   the error of the method, which is of second order;
// - a contact that the loads keep closed, and whose vibration the steps do not resolve, gets the critical
// damping of its spring, and steps grow to the requested ones.
#pragma once

#include <functional>
#include <optional>

#include "mbd_server/model/model.hpp"
#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd {

struct StopCounters {
  std::uint64_t contacts = 0;  // begun
  std::uint64_t steps = 0;     // taken in contacts that are resolved
  std::uint64_t settled = 0;   // contacts that got critical damping
  std::uint64_t crowded = 0;   // of those, contacts that settled because too many began within one step
};

// Which vibration of a contact counts as unresolved.
struct ContactResolution {
  double step = 0;  // fixed steps: the requested step [s]; a stop's time constant below it counts
  // Error control: an amplitude below it, in System::norm(), counts [-]; 0: fixed steps.
  double tolerance = 0;
};

class StopContacts {
 public:
  // Takes one step of at most the given length of the state, and returns its length [s].
  using Stride = std::function<double(double)>;

  StopContacts(const Model& model, GeneralizedAlpha& method, System& system, const State& state);

  // Sets the state to no contacts. Call before the integrator's start.
  void prepare(State& state) const;
  // Call at the begin of what the following calls of step() cover: one fixed step, or one window under
  // error control.
  void begin(const ContactResolution& resolution);
  // Takes one step of at most h that passes no begin or end of a contact. Returns its length, which may be
  // 0 [s].
  double step(State& state, double h, const Stride& stride);

  const StopCounters& counters() const { return counters_; }
  // Calls f(energy, account) for the energy that the contacts of each stop lost since the last call in
  // addition to the work of their force, because of their restitution [J].
  template <class F>
  void take_lost(F&& f) {
    if (!any_lost_) return;
    for (int i = 0; i < std::ssize(model_.stops); ++i)
      if (lost_[i] != 0) f(lost_[i], force(i).account);
    lost_.setZero();
    any_lost_ = false;
  }
  // What a step that is taken back has counted.
  struct Mark {
    StopCounters counters;
    VectorXd lost;
    bool any_lost = false;
    int contacts_in_step = 0;
  };
  Mark mark() const { return {counters_, lost_, any_lost_, contacts_in_step_}; }
  void back(const Mark& mark) {
    counters_ = mark.counters, lost_ = mark.lost, any_lost_ = mark.any_lost;
    contacts_in_step_ = mark.contacts_in_step;
  }

 private:
  struct Event {
    double value = -1;  // depth of a free coordinate, or distance of one in contact, over its tolerance;
                        // above 1 the limit is passed
    double rate = 0;    // of that [1/s]
    int stop = none;
  };

  const JointForce& force(int i) const {
    return model_.joint_forces[static_cast<std::size_t>(model_.stops[i])];
  }
  const Link& link(int i) const { return model_.links[force(i).link]; }
  Event event(const State& state, int i) const;
  Event latest_event(const State& state) const;
  std::optional<double> passed(State& state, double h);
  double cut(State& state, double h, double first);
  void change(State& state, int ended = none);
  void respond(int i);
  void enter(State& state, int i);
  void leave(State& state, int i);
  void settle(State& state, int i);
  bool pressed(const State& state, int i, double acceleration) const;
  double unseen_amplitude(int i) const;
  bool wake(State& state, int i);
  bool settle_lasting(State& state);
  // Whether the contact may end soon, or has not settled yet.
  bool young(const State& state, int i) const;
  bool bounces(const State& state, int i) const;
  double longest_step(const State& state, int i) const;
  bool resolved(const State& state, double h) const;
  void accept(State& state);

  const Model& model_;
  GeneralizedAlpha& method_;
  System& system_;
  ContactResolution resolution_;
  int contacts_in_step_ = 0;
  StopCounters counters_;
  bool any_lost_ = false;
  VectorXd lost_;             // [J] (stops)
  VectorXd tolerance_;        // distance within which a coordinate counts as being at its limit (stops)
  std::vector<int> changed_;  // stops whose contact begins or ends
  State before_, after_;
  VectorXd unit_, response_, dlambda_, zero_;  // e, A^-1 e (freedoms); (constraints)
};

}  // namespace tandem::mbd
