#include "mbd_server/step/contact_ledger.hpp"

#include <algorithm>

namespace tandem::mbd {
namespace {

ContactExchange exchange_of(const ContactForce& f) {
  const double gap_rate = f.n.dot(f.velocity);
  return {{f.gap, gap_rate, f.stretch, f.velocity - gap_rate * f.n, f.bend, f.rolling, f.last_stretch,
           f.last_bend},
          f.normal,
          f.power(),
          f.energy,
          f.slides,
          f.rolls};
}

}  // namespace

ContactLedger::ContactLedger(const Model& model) : model_(model) {
  lost_of_.assign(model.contact.outputs.size(), 0);
  for (const ContactShape& shape : model.contact.shapes) {
    const auto found = std::ranges::find(model.boundary, shape.body);
    const bool has = shape.body != none && found != model.boundary.end();
    boundary_of_.push_back(has ? static_cast<int>(found - model.boundary.begin()) : none);
    records_impulses_ = records_impulses_ || has;
  }
  if (!model.contact.empty()) impulses_.setZero(6, std::ssize(model.boundary));
}

void ContactLedger::lose(double energy, int shape_a, int shape_b) {
  lost_ += energy;
  model_.contact.for_each_output(
      shape_a, shape_b, [&](int output, double) { lost_of_[static_cast<std::size_t>(output)] += energy; });
}

void ContactLedger::record(const State& state, const std::vector<LinkMotion>& links, Exchanges& at,
                           Wrenches& wrenches) {
  at.resize(state.contacts.size());
  if (records_impulses_) wrenches.setZero(6, std::ssize(model_.boundary));
  const auto add = [&](int shape, const ContactForce& f, double sign) {
    const int k = boundary_of_[static_cast<std::size_t>(shape)];
    if (k == none) return;
    const BodyOnLink& body =
        model_.bodies[static_cast<std::size_t>(model_.boundary[static_cast<std::size_t>(k)])];
    const Vector3d centre = links[static_cast<std::size_t>(body.link)].point(body.p_LB);
    wrenches.col(k) += sign * wrench_at(f.p - centre, f.force, f.torque);
  };
  for (std::size_t k = 0; k < state.contacts.size(); ++k) {
    const ContactPoint& point = state.contacts[k];
    const ContactForce f = evaluate(model_, point, links, Derivatives::without);
    at[k] = exchange_of(f);
    if (!records_impulses_) continue;
    add(point.feature.b, f, 1);
    add(point.feature.a, f, -1);
  }
}

void ContactLedger::integrate_wrenches(State& state, const GeneralizedAlpha& method, double h) {
  if (!records_impulses_) return;
  const GeneralizedAlphaConstants& c = method.constants();
  Wrenches last = state.contact_wrench;
  if (method.began_afresh()) last = begin_wrench_ + (c.alpha_m - c.alpha_f) * (end_wrench_ - begin_wrench_);
  state.contact_wrench =
      ((1 - c.alpha_f) * end_wrench_ + c.alpha_f * begin_wrench_ - c.alpha_m * last) / (1 - c.alpha_m);
  impulses_ = h * ((1 - c.gamma) * last + c.gamma * state.contact_wrench);
}

// By Simpson's rule; in the middle of the step gap, stretch and bend are those of the cubics through both
// ends (energy_balance.hpp). A cubic is far from the motion where the step does not resolve the contact: then
// it is the mean of the forces at both ends, at the mean rate. Dampers have the force of that rate, so that
// they return no energy, and friction is bounded by the normal force that was there: a normal rate far below
// the mean one of the step counts in that of stiff dampers.
double ContactLedger::work(const ContactPoint& point, std::size_t k, double h) const {
  if (!(h > 0)) return 0;
  const ContactExchange &begin = begin_[k], &end = end_[k];
  const auto between = [&](const auto& x0, const auto& x1, const auto& v0, const auto& v1, auto& x, auto& v) {
    x = 0.5 * (x0 + x1) + h / 8 * (v0 - v1);
    v = 1.5 / h * (x1 - x0) - 0.25 * (v0 + v1);
  };
  const ContactMotion &m0 = begin.motion, &m1 = end.motion;
  if (h > ContactRules::growth * point.period / ContactRules::steps_per_vibration) {
    ContactMotion first = m0, last = m1;
    first.gap_rate = last.gap_rate = (m1.gap - m0.gap) / h;
    first.sliding = last.sliding = (m1.stretch - m0.stretch) / h;
    first.rolling = last.rolling = (m1.bend - m0.bend) / h;
    return 0.5 * h * (power(model_, point, first, begin.normal) + power(model_, point, last, end.normal));
  }
  ContactMotion middle;
  between(m0.gap, m1.gap, m0.gap_rate, m1.gap_rate, middle.gap, middle.gap_rate);
  between(m0.stretch, m1.stretch, m0.sliding, m1.sliding, middle.stretch, middle.sliding);
  between(m0.bend, m1.bend, m0.rolling, m1.rolling, middle.bend, middle.rolling);
  middle.last_stretch = 0.5 * (m0.last_stretch + m1.last_stretch);
  middle.last_bend = 0.5 * (m0.last_bend + m1.last_bend);
  return h / 6 * (begin.power + 4 * power(model_, point, middle) + end.power);
}

}  // namespace tandem::mbd
