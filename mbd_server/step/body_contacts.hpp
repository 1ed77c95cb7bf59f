// Contacts between bodies. As stops of joints (stop_contacts.hpp), they are events of the motion:
//
// - a step that would pass the begin of a contact is repeated so that it ends there, to 1e-10 of the size of
//   the system, and to 1 % of the depth under the weight of the body; a step that would pass an end is
//   repeated so that it ends there to 1 % of its length: a force that falls to zero within a step would give
//   more impulse than it has;
// - for the duration of an impact, and for some more while the point bounces, steps are a part of that
//   duration, and grow after it; they do so again where loads make a contact vibrate, and a longer step is
//   repeated;
// - a contact is faint that begins or ends at a rate at which bodies that are pressed together flicker: no
//   step ends there, and no impact is resolved. A point that leaves at such a rate stays among the contacts,
//   without a force, while it may come back at no more than it;
// - where impacts are not resolved (BodyContactModel::within_steps), no contact cuts or shortens a step: one
//   that may begin within a step is among its points, without a force until it bears, and error control finds
//   the length that the change of the force needs;
// - after each step, friction that slides moves the ends of its spring (contact_force.hpp), so that the
//   spring has the force with which the step ended.
//
// This class orders a step. What it is made of:
//   contact_rules.hpp       which contacts matter, and which steps resolve them; reads only
//   contact_candidates.hpp  features and their matching with points; changes features, drops points
//   contact_masses.hpp      inertia at a point; uses the linear solver
//   contact_cuts.hpp        where steps end; reads only
//   contact_springs.hpp     springs along the surfaces; changes these
//   contact_ledger.hpp      energy and impulse; changes State::contact_wrench
#pragma once

#include <functional>
#include <optional>

#include "mbd_server/step/contact_cuts.hpp"
#include "mbd_server/step/contact_masses.hpp"
#include "mbd_server/step/stiction.hpp"
#include "mbd_server/step/stop_contacts.hpp"

namespace tandem::mbd {

struct BodyContactCounters {
  std::uint64_t contacts = 0;  // points that came into contact
  std::uint64_t steps = 0;     // taken with a point in contact
  // Time stepping: steps whose friction does not fit the normal forces to the tolerance.
  std::uint64_t unsettled = 0;
  // Time stepping: points that began to push in a step in which the shapes moved past each other by more than
  // half of that from the surface to the middle of the thinner one.
  std::uint64_t passing = 0;
  // Time stepping: points that push while a shape that is no sphere turns by more than half a radian in the
  // step.
  std::uint64_t turning = 0;
  // Time stepping: points that came into contact in a step too long for the rebound of their materials.
  std::uint64_t dull = 0;
};

// Energy of the contacts at the start that no load holds: it throws bodies apart.
struct ReleasedAtStart {
  double energy = 0;                  // [J]
  double largest = 0;                 // of one point, whose data follow [J]
  double depth = 0, depth_share = 0;  // [m]; over that to the middle of the thinner shape [-]
  int shape_a = none, shape_b = none;
};

class BodyContacts {
 public:
  // Takes one step of at most the given length of the state, and returns its length [s].
  using Stride = std::function<double(double)>;

  // A step that is repeated takes back what `stops` and `stiction` have counted in it.
  BodyContacts(const Model& model, GeneralizedAlpha& method, MachineSystem& system, const State& state,
               StopContacts& stops, Stiction& stiction);
  BodyContacts(const BodyContacts&) = delete;
  BodyContacts& operator=(const BodyContacts&) = delete;

  // Sets the contacts of a state at the start: shapes that overlap or touch there are in contact.
  void prepare(State& state);
  // Finds what is released at the start, when the method has started there.
  void note_start(State& state, double h);
  const ReleasedAtStart& released() const { return released_; }
  // The requested step, up to which steps grow again after a contact [s], the energy that moves [J], and
  // whether many pairs are in contact in the scene, of which these bodies are a part.
  void begin(double requested, double energy_scale, bool crowded = false) {
    requested_ = requested;
    crowded_ = crowded;
    rules_.set_energy_scale(energy_scale);
  }
  // Takes one step of at most h that passes no begin of a contact. Returns its length [s].
  double step(State& state, double h, const Stride& stride);

  const BodyContactCounters& counters() const { return counters_; }
  // Adds what an island has counted from `before` to `after`.
  void count(const BodyContactCounters& before, const BodyContactCounters& after) {
    counters_.contacts += after.contacts - before.contacts;
    counters_.steps += after.steps - before.steps;
    counters_.unsettled += after.unsettled - before.unsettled;
    counters_.passing += after.passing - before.passing;
    counters_.turning += after.turning - before.turning;
    counters_.dull += after.dull - before.dull;
  }
  // Sets what the last step of all islands has lost [J], and its extremes.
  void set_of_islands(double lost, const ContactExtremes& extremes) {
    ledger_.lose(lost);
    extremes_ = extremes;
  }
  // Energy that contacts have dissipated since the last call [J].
  double take_lost() { return ledger_.take_lost(); }
  // Calls f(energy, account) with the shares of the outputs in it [J].
  template <class F>
  void take_lost_of_outputs(F&& f) {
    ledger_.take_lost_of_outputs(f);
  }
  // Of the last step.
  const ContactExtremes& extremes() const { return extremes_; }
  // Impulse of the contacts on each boundary body in the last step: torque about its centre of mass, force
  // [N m s], [N s] (6 x boundary bodies). The momentum of a free body changes by it to rounding, because it
  // is that of the algorithmic wrench (State::contact_wrench).
  const ContactLedger::Wrenches& impulses() const { return ledger_.impulses(); }

 private:
  void expect_outside() const;
  void expect_apart(const State& state, double share, ErrorCode code, const char* what,
                    const char* hint) const;
  void expect_progress(double h, double taken, const std::optional<ContactPassage>& first);
  void make_ready(State& state, double h);
  void measure(State& state, ContactGaps& gaps);
  void go_back(State& state);
  double repeat(State& state, double h, const Stride& stride);
  double cut(State& state, double h, const ContactPassage& first, const Stride& stride);
  // `ahead`: longest step in which points within steps may begin; `uncut`: the same, where impacts are
  // resolved.
  bool enter_all(State& state, double ahead = 0, double uncut = 0, bool at_start = false);
  void enter(State& state, const ContactEntry& entry);
  void shorten(State& state, double longest) const;
  bool accept(State& state, double h);
  void start_method(State& state);

  const Model& model_;
  GeneralizedAlpha& method_;
  MachineSystem& system_;
  StopContacts& stops_;
  Stiction& stiction_;
  ContactRules rules_;
  ContactLedger ledger_;
  ContactCandidates candidates_;
  ContactMasses masses_;
  StopContacts::Mark stops_before_;
  StictionCounters stiction_before_;
  ShortenedSteps shortened_before_;
  State before_;
  double requested_ = 0;  // [s]
  bool crowded_ = false;
  BodyContactCounters counters_;
  ContactExtremes extremes_;
  ReleasedAtStart released_;
  int stalled_ = 0;  // steps in a row without length
  std::vector<ContactEntry> entries_;
  ContactGaps gaps_before_, gaps_;
  VectorXd moved_;  // (freedoms)
};

}  // namespace tandem::mbd
