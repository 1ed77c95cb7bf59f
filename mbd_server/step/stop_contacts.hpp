// Contacts of joint coordinates with their stops. A stop is a stiff spring on one side: a step that does not
// end where a contact begins and ends gives the coordinate an impulse that depends on where the step happens
// to stand. So
//
// - a step that would pass the begin or the end of a contact is repeated so that it ends there; between, each
// stop
//   pushes or does not push, and the forces are smooth;
// - in a contact, and after it until the step has grown again, steps are a part of the contact's duration
//   T = pi sqrt(m / k), with m the inertia that the stop feels, 1 / m = e^T A^-1 e (Schwieger, closures
//   included);
// - the work of the accelerations along the coordinate, in which the stop's spring returns what it got and
// its damping
//   takes, gives the rate at which a contact ends: u^2/2 = v^2/2 + sum (u'_0 + u'_1)/2 (q_1 - q_0). The error
//   of the method, of second order, is taken out by an impulse through the mass matrix;
// - a contact that the loads press so that it is not left again, and whose vibration nobody resolves, gets
// the critical
//   damping of its spring, and steps grow to those that are asked for.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "mbd_server/model/model.hpp"
#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd {

struct StopCounters {
  std::uint64_t contacts = 0;  // begun
  std::uint64_t steps = 0;     // taken in contacts that are resolved
  std::uint64_t settled = 0;   // contacts that got critical damping
  std::uint64_t crowded = 0;   // of those, because of too many contacts within one step
};

// What vibration of a contact counts as unresolved.
struct ContactResolution {
  double step = 0;       // fixed: the step that is asked for [s]; a stop's time constant below it
  double tolerance = 0;  // error control: an amplitude below it, in System::norm() [-]; 0: fixed
};

class StopContacts {
 public:
  // Takes one step of at most the given length of the state, and returns its length [s].
  using Stride = std::function<double(double)>;

  StopContacts(const Model& model, GeneralizedAlpha& method, System& system, const State& state);

  // No contacts. To be called before the integrator's start.
  void prepare(State& state) const;
  // To be called at the begin of what step() then covers in parts: one fixed step, or one window under error
  // control.
  void begin(const ContactResolution& resolution);
  // One step of at most h that passes no begin or end of a contact. Returns its length, which may be 0 [s].
  double step(State& state, double h, const Stride& stride);

  const StopCounters& counters() const { return counters_; }
  // What contacts lost since the last call beyond the work of their force, because of their restitution [J].
  double take_lost() { return std::exchange(lost_, 0.0); }

 private:
  struct Event {
    double value =
        -1;  // depth of a free coordinate, or distance of one in contact, over its tolerance: > 1 is passed
    double rate = 0;  // of that [1/s]
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
  bool settle_lasting(State& state);
  // Contacts that may end soon, or have not settled yet.
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
  double lost_ = 0;           // [J]
  VectorXd tolerance_;        // within which a coordinate is at its limit (stops)
  std::vector<int> changed_;  // stops whose contact begins or ends
  State before_, after_;
  VectorXd unit_, response_, dlambda_, zero_;  // e, A^-1 e (freedoms); (constraints)
};

}  // namespace tandem::mbd
