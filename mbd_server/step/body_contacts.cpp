#include "mbd_server/step/body_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/overlap.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/step/contact_springs.hpp"

namespace tandem::mbd {
namespace {

// A step in which a ball goes through a face is halved down to this share of it.
constexpr double least_halved = 1e-3;
// Steps below this share of the time make no progress; more of them in a row, and as many as there are
// points, are an error.
constexpr double least_progress = 1e-14;
constexpr int most_stalled = 100;
// A step that passes begins or ends of contacts of so many pairs is not cut at the first of them, where steps
// between these shares of its length need no cut at any of them.
constexpr int many = 3;
constexpr double worthwhile = 0.1, shorter = 0.9;

double shortest_period(const State& state) {
  double shortest = HUGE_VAL;
  for (const ContactPoint& point : state.contacts) shortest = std::min(shortest, point.period);
  return shortest;
}

}  // namespace

BodyContacts::BodyContacts(const Model& model, GeneralizedAlpha& method, MachineSystem& system,
                           const State& state, StopContacts& stops, Stiction& stiction)
    : model_(model),
      method_(method),
      system_(system),
      stops_(stops),
      stiction_(stiction),
      rules_(model),
      ledger_(model),
      candidates_(model, rules_, ledger_),
      masses_(model, system),
      before_(state) {}

// Throws where two shapes overlap by more than this share of the thinner one: what they do then is no
// contact.
void BodyContacts::expect_apart(const State& state, double share, ErrorCode code, const char* what,
                                const char* hint) const {
  for (const ContactPoint& point : state.contacts) {
    const double depth = -evaluate(model_, point, system_.links(), Derivatives::without).gap;
    const ContactFeature& feature = point.feature;
    const double thinner = thickness_at(model_, feature);
    if (!(depth > share * thinner)) continue;
    throw Error(code,
                fmt::format("{} and {} {}, by {:.3g} m; the thinner one reaches {:.3g} m from its middle",
                            model_.contact.shape(feature.a).name, model_.contact.shape(feature.b).name, what,
                            depth, thinner),
                "mbd.contact",
                hint + (code == ErrorCode::scene
                            ? files_of(model_.contact.shape(feature.a), model_.contact.shape(feature.b))
                            : std::string()));
  }
}

double BodyContacts::step(State& state, double h, const Stride& stride) {
  if (model_.contact.empty()) return stride(h);
  system_.residual(state);
  rules_.look_at(state.contacts, crowded_);
  const double room = rules_.crowded() && state.touch_step[0] > 0 ? std::min(h, state.touch_step[0]) : h;
  candidates_.find(system_.links(), room, state.contacts);
  if (candidates_.turned()) shorten(state, *candidates_.turned());
  system_.residual(state);
  if (enter_all(state, h, room) || candidates_.turned()) start_method(state);
  measure(state, gaps_before_);
  candidates_.mark_balls(system_.links());
  before_ = state;
  stops_before_ = stops_.mark();
  stiction_before_ = stiction_.counters();
  shortened_before_ = method_.shortened();
  ledger_.record_begin(state, system_.links());
  double limit = longest_step(model_, system_.links(), state, candidates_, gaps_before_, h), taken = 0;
  while (true) {
    const double planned = limit < h ? h / std::ceil(h / limit * (1 - 1e-9)) : h;
    make_ready(state, planned);
    taken = stride(planned);
    // Where Newton's method fails, the contacts may be what the step does not resolve.
    const double resolved = shortest_period(before_) / ContactRules::steps_per_vibration;
    if (method_.shortened().count > shortened_before_.count && taken > ContactRules::growth * resolved) {
      limit = resolved;
      go_back(state);
      state.touch_step[0] = limit;
      continue;
    }
    measure(state, gaps_);
    if (taken > least_halved * h && candidates_.went_through(system_.links(), gaps_)) {
      limit = 0.5 * taken;
      go_back(state);
      continue;
    }
    const ContactPassages passages =
        find_passages(candidates_, rules_, state.contacts, gaps_before_, gaps_, taken);
    const auto& first = passages.first;
    // One shorter step instead of one for each of these contacts.
    if (passages.pairs >= many && passages.uncut_step > worthwhile * taken &&
        passages.uncut_step < shorter * taken) {
      go_back(state);
      state.touch_step[0] = passages.uncut_step;
      return step(state, h, stride);
    }
    if (first) taken = cut(state, taken, *first, stride);
    expect_progress(h, taken, first);
    ledger_.record_end(state, system_.links());
    const double resolving = resolving_step(rules_, ledger_, state, before_.time, taken);
    if (taken <= ContactRules::growth * resolving) break;
    limit = resolving;
    go_back(state);
  }
  ledger_.integrate_wrenches(state, method_, taken);
  const bool impact_ended = accept(state, taken);
  expect_apart(state, 1, ErrorCode::numerics, "pass through each other",
               "give their materials more stiffness, so that they stop each other before that");
  // After the end of an impact the algorithmic acceleration still has a part of its force, whose effect would
  // grow with the steps.
  if (enter_all(state) || impact_ended) start_method(state);
  return taken;
}

// Before a step of length h, or of the one that error control tries next. The rate of u' over a much shorter
// step before, in which a contact ended or began, tells nothing of this one (GeneralizedAlpha::start()).
void BodyContacts::make_ready(State& state, double h) {
  if (state.next_step > 0) h = std::min(h, state.next_step);
  aim_springs(model_, system_.links(), h, state.contacts);
  aim_rolling_springs(model_, system_.links(), h, state.contacts);
  if (h > ContactRules::growth * state.step &&
      h * h * system_.norm(state.udot_rate) > system_.norm(state.u) + h * system_.norm(state.udot))
    state.udot_rate.setZero();
}

// Throws where events of contacts leave no length to many steps in a row.
void BodyContacts::expect_progress(double h, double taken, const std::optional<ContactPassage>& first) {
  stalled_ = first && taken <= least_progress * std::max(h, before_.time) ? stalled_ + 1 : 0;
  if (stalled_ <= most_stalled + std::ssize(candidates_.all())) return;
  const ContactFeature& f = candidates_[first->candidate].feature;
  throw Error(ErrorCode::numerics,
              fmt::format("{} and {} begin and end their contact without end", model_.contact.shape(f.a).name,
                          model_.contact.shape(f.b).name),
              "mbd.contact",
              "give their materials a lower restitution, or move one of them a little at the start");
}

void BodyContacts::measure(State& state, ContactGaps& gaps) {
  system_.residual(state);
  candidates_.measure(system_.links(), gaps);
}

void BodyContacts::go_back(State& state) {
  state = before_;
  stops_.back(stops_before_);
  stiction_.back(stiction_before_);
  method_.back(shortened_before_);
  system_.residual(state);
}

double BodyContacts::repeat(State& state, double h, const Stride& stride) {
  go_back(state);
  make_ready(state, h);
  const double taken = stride(h);
  measure(state, gaps_);
  return taken;
}

// Repeats the step so that it ends at the first begin or end of a contact.
double BodyContacts::cut(State& state, double h, const ContactPassage& first, const Stride& stride) {
  StepCut search(first, candidates_, rules_, h, state.time);
  while (true) {
    const double taken = repeat(state, search.length(), stride);
    switch (search.look(taken, gaps_)) {
      case StepCut::Verdict::done:
        return taken;
      case StepCut::Verdict::whole:
        return repeat(state, h, stride);
      case StepCut::Verdict::again:
        break;
    }
  }
}

// A start of the method sets `a` from the forces there.
void BodyContacts::start_method(State& state) {
  method_.start(system_, state,
                longest_step(model_, system_.links(), state, candidates_, gaps_before_, requested_));
  ledger_.start_wrenches(state, system_.links());
}

}  // namespace tandem::mbd
