#include "mbd_server/step/stop_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/step/cubic.hpp"

namespace tandem::mbd {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double steps_per_stop_contact = 32;
// Largest error of rate^2/2 of a step in a contact, relative to rate^2/2 at the contact's begin: three times
// the error of a step of the length above.
constexpr double largest_defect = 1e-3;
// Contacts that end again last one to three times as long as a contact without loads.
constexpr double lasting_stop = 10;
constexpr double settling = 4;  // durations of a contact after which critical damping leaves 5e-5
// Rate that loads give within 1 / frequency, relative to the entry rate: below this value the restitution is
// that of the contact with its loads (1 kg that falls 0.1 m on 2e6 N/m).
constexpr double small_load = 1. / 200;
// A settled contact whose depth changes within 1 / frequency by this many tolerances has another load.
constexpr double awake = 10;
constexpr int most_contacts_in_step = 1000;
constexpr double growth_after_stop = 2;  // of the steps after a contact

}  // namespace

StopContacts::StopContacts(const Model& model, GeneralizedAlpha& method, System& system, const State& state)
    : model_(model),
      method_(method),
      system_(system),
      lost_(VectorXd::Zero(std::ssize(model.stops))),
      tolerance_(std::ssize(model.stops)),
      before_(state),
      after_(state),
      unit_(VectorXd::Zero(state.u.size())),
      response_(unit_),
      dlambda_(VectorXd::Zero(system.constraints())),
      zero_(dlambda_) {
  changed_.reserve(model.stops.size());
  for (int i = 0; i < std::ssize(model.stops); ++i) {
    const scene::Limits& limits = *force(i).limits;
    tolerance_[i] =
        1e-12 * model.scale[link(i).u] + 1e-15 * std::max(std::abs(limits.lower), std::abs(limits.upper));
  }
}

void StopContacts::prepare(State& state) const {
  state.stops.setZero(StopRow::count, std::ssize(model_.stops));
  state.contact_step = 0;
}

void StopContacts::begin(const ContactResolution& resolution) {
  resolution_ = resolution;
  contacts_in_step_ = 0;
}

double StopContacts::step(State& state, double h, const Stride& stride) {
  if (model_.stops.empty()) return stride(h);
  change(state);
  while (true) {
    before_ = state;
    const double limit = state.contact_step;
    const double wanted = limit > 0 && limit < h ? h / std::ceil(h / limit * (1 - 1e-9)) : h;
    const double taken = stride(wanted);
    if (const std::optional<double> first = passed(state, taken)) {
      const double part = cut(state, taken, *first);
      const int stop = latest_event(state).stop;
      accept(state);
      change(state, stop);
      return part;
    }
    if (resolved(state, taken)) {
      accept(state);
      return taken;
    }
    state = before_;
    state.contact_step = taken / 2;
  }
}

StopContacts::Event StopContacts::event(const State& state, int i) const {
  const JointForce& f = force(i);
  const double q = state.q[link(i).q], u = state.u[link(i).u];
  const double side = state.stops(StopRow::entry_rate, i);
  if (side == 0) {
    const Depth at = depth(*f.limits, q);
    return {at.depth / tolerance_[i], at.direction * u / tolerance_[i], i};
  }
  const double out = side > 0 ? -1 : 1;
  return {out * (q - (side > 0 ? f.limits->upper : f.limits->lower)) / tolerance_[i], out * u / tolerance_[i],
          i};
}

StopContacts::Event StopContacts::latest_event(const State& state) const {
  Event latest{-HUGE_VAL};
  for (int i = 0; i < std::ssize(model_.stops); ++i)
    if (const Event e = event(state, i); e.value > latest.value) latest = e;
  return latest;
}

// Estimates when a step of length h passes the first begin or end of a contact.
std::optional<double> StopContacts::passed(State& state, double h) {
  std::optional<double> first;
  double turn = HUGE_VAL;
  for (int i = 0; i < std::ssize(model_.stops); ++i) {
    const Event e0 = event(before_, i), e1 = event(state, i);
    const Cubic path{e0.value, h * e0.rate, e1.value, h * e1.rate};
    if (e1.value > 1) {
      // A coordinate that has just left its limit moves away from it first.
      const double away = e0.rate < 0 ? bisect([&](double x) { return path.slope(x); }) : 0;
      first = std::min(first.value_or(h), h * bisect(path, away));
    } else if (e0.rate > 0 && e1.rate < 0 && state.stops(StopRow::entry_rate, i) == 0) {
      // The coordinate may have passed its limit and returned.
      const double t = bisect([&](double x) { return -path.slope(x); });
      if (path(t) > 1) turn = std::min(turn, h * t);
    }
  }
  if (first || turn >= h) return first;
  after_ = state;
  state = before_;
  if (method_.try_step(system_, state, turn) && latest_event(state).value > 1) return turn;
  state = after_;
  return {};
}

// Repeats the step so that it ends at the first begin or end of a contact.
double StopContacts::cut(State& state, double h, double first) {
  double low = 0, high = h, part = first;
  while (true) {
    state = before_;
    if (!method_.try_step(system_, state, part)) {
      if (high - low <= 1e-15 * std::max(h, state.time)) method_.give_up(system_, part);
      high = part;
      part = (low + high) / 2;
      continue;
    }
    const Event e = latest_event(state);
    const bool at_limit = std::abs(e.value) <= 0.5;
    if ((at_limit && e.rate > 0) || high - low <= 1e-15 * std::max(h, state.time)) return part;
    (e.value > 0 && !at_limit ? high : low) = part;
    const double newton = part - e.value / e.rate;
    part = newton > low && newton < high ? newton : (low + high) / 2;
  }
}

// Contacts that begin, end or settle in this state; `ended` is one that ends. Others end with it, except
// those that loads press: these may rest at a depth below the tolerance.
void StopContacts::change(State& state, int ended) {
  changed_.clear();
  for (int i = 0; i < std::ssize(model_.stops); ++i) {
    const Event e = event(state, i);
    const bool here = e.value >= -1 || i == ended;
    if (state.stops(StopRow::entry_rate, i) == 0) {
      const double load = depth(*force(i).limits, state.q[link(i).q]).direction * state.udot[link(i).u];
      if (e.value > 1 || (here && (e.rate > 0 || (e.rate == 0 && load > 0)))) changed_.push_back(i);
    } else if (here && e.rate > 0 && (i == ended || state.stops(StopRow::damping, i) == 0)) {
      changed_.push_back(i);
    }
  }
  if (!changed_.empty()) {
    system_.residual(state);
    response_.setZero();
    system_.factorise({.mass = 1, .damping = 0, .stiffness = 0}, response_);
    for (const int i : changed_) state.stops(StopRow::entry_rate, i) == 0 ? enter(state, i) : leave(state, i);
  }
  if (!settle_lasting(state) && changed_.empty()) return;
  if (state.contact_step >= resolution_.step) state.contact_step = 0;
  method_.start(system_, state, state.contact_step > 0 ? state.contact_step : resolution_.step);
}

// A^-1 e of the stop's coordinate, closures included: the change of the rates by a unit impulse of the stop.
void StopContacts::respond(int i) {
  unit_.setZero();
  unit_[link(i).u] = 1;
  system_.solve(unit_, zero_, response_, dlambda_);
}

void StopContacts::enter(State& state, int i) {
  const JointForce& f = force(i);
  const Depth at = depth(*f.limits, state.q[link(i).q]);
  respond(i);
  const double frequency = std::sqrt(f.limits->stiffness * std::max(0.0, response_[link(i).u]));
  const double rate = state.u[link(i).u], load = at.direction * state.udot[link(i).u];
  double entry = std::hypot(std::max(0.0, at.direction * rate), frequency * std::max(0.0, at.depth));
  if (frequency > 0) entry = std::max(entry, load / frequency);
  auto contact = state.stops.col(i);
  // Where closures hold a coordinate, its rate is 0 or round-off, and any value will do.
  contact[StopRow::entry_rate] = at.direction * (frequency > 0 && entry > 0 ? entry : 1);
  contact[StopRow::entry_time] = state.time;
  contact[StopRow::frequency] = frequency;
  contact[StopRow::work] = rate * rate / 2;
  contact[StopRow::damping] = 0;
  ++counters_.contacts;
  const bool crowded = ++contacts_in_step_ > most_contacts_in_step;
  if (crowded) ++counters_.crowded;
  if (crowded || pressed(state, i, load)) settle(state, i);
  const double longest = longest_step(state, i);
  state.contact_step = state.contact_step > 0 ? std::min(state.contact_step, longest) : longest;
}

// The impulse that corrects the rate to the value given by the work acts on the whole machine. Where that
// value differs from the restitution by no more than a small load explains, the restitution is that of the
// contact with its load.
void StopContacts::leave(State& state, int i) {
  const double rate = state.u[link(i).u], work = state.stops(StopRow::work, i);
  if (bounces(state, i)) {
    respond(i);
    double size = std::sqrt(2 * std::max(0.0, work));
    const double entry = std::abs(state.stops(StopRow::entry_rate, i)),
                 frequency = state.stops(StopRow::frequency, i);
    const scene::Limits& limits = *force(i).limits;
    if (limits.restitution.value_or(1) < 1) {
      const double returned = *limits.restitution * entry, load = std::abs(state.udot[link(i).u]) / frequency;
      if (load <= small_load * entry && std::abs(size - returned) <= 2 * load + 1e-3 * entry) {
        if (response_[link(i).u] > 0) {
          lost_[i] += (work - returned * returned / 2) / response_[link(i).u];
          any_lost_ = true;
        }
        size = returned;
      }
    }
    const double wanted = std::copysign(size, rate);
    if (response_[link(i).u] > 0) response_ *= (wanted - rate) / response_[link(i).u];
    for (int k = 0; k < std::ssize(model_.stops); ++k) {
      const double u = state.u[link(k).u];
      state.stops(StopRow::work, k) += (u + response_[link(k).u] / 2) * response_[link(k).u];
    }
    state.u += response_;
  }
  const double longest = longest_step(state, i);
  if (state.contact_step == 0 || state.contact_step > longest) state.contact_step = longest;
  state.stops.col(i).setZero();
}

void StopContacts::settle(State& state, int i) {
  auto contact = state.stops.col(i);
  if (!(contact[StopRow::frequency] > 0)) return;
  contact[StopRow::damping] = 2 * force(i).limits->stiffness / contact[StopRow::frequency];
  contact[StopRow::entry_time] = state.time;
  ++counters_.settled;
}

// Whether a load, the acceleration into the stop without the stop's force, keeps the contact closed, and its
// vibration about the static depth is not resolved. The load of another contact that bounces lasts no longer
// than that contact.
bool StopContacts::pressed(const State& state, int i, double acceleration) const {
  const double frequency = state.stops(StopRow::frequency, i);
  if (!(frequency > 0)) return false;
  for (int k = 0; k < std::ssize(model_.stops); ++k)
    if (k != i && bounces(state, k)) return false;
  const double d = -event(state, i).value * tolerance_[i], load = acceleration / frequency;
  const double vibration = std::hypot(state.u[link(i).u], frequency * d - load);  // as a rate
  if (!(load > 0) || !(vibration <= std::numbers::sqrt2 * load)) return false;
  if (resolution_.tolerance == 0) return frequency * resolution_.step > 1;
  return vibration / frequency <= unseen_amplitude(i);
}

// Amplitude of a vibration that error control does not see [rad or m].
double StopContacts::unseen_amplitude(int i) const {
  return resolution_.tolerance * model_.scale[link(i).u] * std::sqrt(static_cast<double>(model_.freedoms));
}

// A contact that settled under another load is elastic again: critical damping would take what the stop has
// to give back.
bool StopContacts::wake(State& state, int i) {
  auto contact = state.stops.col(i);
  const double frequency = contact[StopRow::frequency], rate = state.u[link(i).u];
  if (contact[StopRow::damping] == 0 || resolution_.tolerance == 0 ||
      contacts_in_step_ > most_contacts_in_step || std::abs(rate) <= awake * frequency * unseen_amplitude(i))
    return false;
  const double into = std::copysign(1.0, contact[StopRow::entry_rate]),
               d = std::max(0.0, -event(state, i).value * tolerance_[i]);
  contact[StopRow::entry_rate] = into * std::hypot(std::max(0.0, into * rate), frequency * d);
  contact[StopRow::entry_time] = state.time;
  contact[StopRow::work] = rate * rate / 2;
  contact[StopRow::damping] = 0;
  return true;
}

bool StopContacts::settle_lasting(State& state) {
  bool any = false;
  for (int i = 0; i < std::ssize(model_.stops); ++i) {
    if (wake(state, i)) {
      const double longest = longest_step(state, i);
      state.contact_step = state.contact_step > 0 ? std::min(state.contact_step, longest) : longest;
      any = true;
      continue;
    }
    const auto contact = state.stops.col(i);
    const double entry = contact[StopRow::entry_rate], frequency = contact[StopRow::frequency];
    if (entry == 0 || contact[StopRow::damping] > 0 || bounces(state, i)) continue;
    const double d = -event(state, i).value * tolerance_[i], into = std::copysign(1.0, entry);
    const double stop = frequency * frequency * std::max(0.0, d) *
                        std::max(0.0, 1 + contact_damping(force(i), entry) * into * state.u[link(i).u]);
    if (!pressed(state, i, into * state.udot[link(i).u] + stop)) continue;
    settle(state, i);
    state.contact_step = longest_step(state, i);
    any = true;
  }
  return any;
}

bool StopContacts::young(const State& state, int i) const {
  const auto contact = state.stops.col(i);
  const double periods = contact[StopRow::damping] > 0 ? settling : lasting_stop;
  return contact[StopRow::frequency] > 0 &&
         (state.time - contact[StopRow::entry_time]) * contact[StopRow::frequency] <= periods * pi;
}

bool StopContacts::bounces(const State& state, int i) const {
  return young(state, i) && state.stops(StopRow::damping, i) == 0;
}

double StopContacts::longest_step(const State& state, int i) const {
  const auto contact = state.stops.col(i);
  const double frequency = contact[StopRow::frequency], entry = contact[StopRow::entry_rate];
  if (!(frequency > 0)) return HUGE_VAL;
  const double x = contact_damping(force(i), entry) * std::abs(entry);
  return pi / (steps_per_stop_contact * frequency * std::sqrt(1 + x));
}

bool StopContacts::resolved(const State& state, double h) const {
  for (int i = 0; i < std::ssize(model_.stops); ++i) {
    if (!bounces(state, i) || h < 1e-3 * longest_step(state, i)) continue;
    const int q = link(i).q, u = link(i).u;
    const double defect = (state.u[u] - before_.u[u]) * (state.u[u] + before_.u[u]) -
                          (state.udot[u] + before_.udot[u]) * (state.q[q] - before_.q[q]);
    const double entry = state.stops(StopRow::entry_rate, i);
    if (!(std::abs(defect) <= largest_defect * entry * entry)) return false;
  }
  return true;
}

void StopContacts::accept(State& state) {
  double longest = HUGE_VAL;
  bool contact = false;
  for (int i = 0; i < std::ssize(model_.stops); ++i) {
    if (state.stops(StopRow::entry_rate, i) == 0) continue;
    const int q = link(i).q, u = link(i).u;
    state.stops(StopRow::work, i) += (state.udot[u] + before_.udot[u]) / 2 * (state.q[q] - before_.q[q]);
    contact = true;
    // A lasting contact that still vibrates stays resolved where the requested steps do not resolve it.
    const bool vibrates = state.stops(StopRow::damping, i) == 0 && resolution_.tolerance == 0 &&
                          state.stops(StopRow::frequency, i) * resolution_.step > 1;
    if (young(state, i) || vibrates) longest = std::min(longest, longest_step(state, i));
  }
  if (contact) ++counters_.steps;
  if (state.contact_step == 0) return;
  state.contact_step = std::min(growth_after_stop * state.contact_step, longest);
  if (state.contact_step >= resolution_.step) state.contact_step = 0;
}

}  // namespace tandem::mbd
