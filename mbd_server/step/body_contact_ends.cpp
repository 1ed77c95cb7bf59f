// What happens to the points in contact at the end of a step: work and impulse, springs that slip, contacts
// that end, and the length of the next step.
#include <algorithm>
#include <cmath>

#include "mbd_server/step/body_contacts.hpp"

namespace tandem::mbd {
namespace {

// A contact vibrates where the energy of its rate is more than this share of the energy that moves.
constexpr double least_vibration = 1e-6;
// An impact of much damping loses most of its rate in a part of this share of its duration: steps there are
// shorter.
constexpr double sudden = 0.125;
// The steps of an impact grow as its rate falls below that of a fall through a share of the size of the body:
// to this many times, from that multiple of the energy of a faint impact.
constexpr double coarsest = 4, coarser_from = 1e3;
// Impacts that end again last one to some durations of one without loads.
constexpr double lasting = 10;
// The spring of friction gets new ends where the point of contact moves away by this share of the radius.
constexpr double rolled = 1e-9;
// That of rolling friction where the normal has turned by this angle against its directions [rad].
constexpr double turned = 1e-2;

// Stretch of a spring that slips: together with its damper it gives `force`, and never more alone.
Vector3d left_over(const Vector3d& force, const Vector3d& damping, double stiffness) {
  const Vector3d elastic = force + damping;
  return elastic.dot(force) > 0 ? Vector3d(-elastic / stiffness) : Vector3d::Zero();
}

}  // namespace

// Longest step of an impact after some time, while it moves at that rate [s].
double BodyContacts::impact_step(const ContactPoint& point, double since, double rate) const {
  const int a = point.feature.a, b = point.feature.b;
  const double period = point.period, number = model_.contact.law(a, b).damping_number,
               fast = coarser_from * faint_square(a, b);
  double step = period / steps_per_contact;
  if (rate * rate < fast) step *= rate > 0 ? std::min(coarsest, std::sqrt(fast) / rate) : 1;
  return since < sudden * period ? step / std::sqrt(1 + 0.5 * number) : step;
}

void BodyContacts::set_rolling_spring(const Vector3d& on_a, const Vector3d& on_b, const LinkMotion& a,
                                      const LinkMotion& b, ContactPoint& point) {
  point.rolling.on_a = a.R_WL.transpose() * on_a;
  point.rolling.on_b = b.R_WL.transpose() * on_b;
}

void BodyContacts::record(const State& state, std::vector<Exchange>& at, Wrenches& wrenches) {
  at.resize(state.contacts.size());
  if (records_impulses_) wrenches.setZero(6, std::ssize(model_.boundary));
  const auto add = [&](int shape, const ContactForce& f, double sign) {
    const int k = boundary_of_[static_cast<std::size_t>(shape)];
    if (k == none) return;
    const BodyOnLink& body =
        model_.bodies[static_cast<std::size_t>(model_.boundary[static_cast<std::size_t>(k)])];
    const Vector3d centre = system_.links()[static_cast<std::size_t>(body.link)].point(body.p_LB);
    wrenches.col(k) += sign * wrench_at(f.p - centre, f.force, f.torque);
  };
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    const ContactForce f = evaluate(model_, state.contacts[k], system_.links(), Derivatives::without);
    at[static_cast<std::size_t>(k)] = exchange_of(f);
    if (!records_impulses_) continue;
    add(state.contacts[k].feature.b, f, 1);
    add(state.contacts[k].feature.a, f, -1);
  }
}

// A start of the method sets `a` from the forces there.
void BodyContacts::start_method(State& state) {
  method_.start(system_, state, longest_step(state, requested_));
  if (!records_impulses_) return;
  record(state, at_begin_, state.contact_wrench);
}

// The momentum of a body changes by the algorithmic acceleration: the impulse of a force over a step is that
// of the algorithmic force.
void BodyContacts::integrate_wrenches(State& state, double h) {
  if (!records_impulses_) return;
  const GeneralizedAlphaConstants& c = method_.constants();
  Wrenches last = state.contact_wrench;
  if (method_.began_afresh())
    last = at_begin_wrench_ + (c.alpha_m - c.alpha_f) * (at_end_wrench_ - at_begin_wrench_);
  state.contact_wrench =
      ((1 - c.alpha_f) * at_end_wrench_ + c.alpha_f * at_begin_wrench_ - c.alpha_m * last) / (1 - c.alpha_m);
  impulses_ = h * ((1 - c.gamma) * last + c.gamma * state.contact_wrench);
}

BodyContacts::Exchange BodyContacts::exchange_of(const ContactForce& f) {
  const double gap_rate = f.n.dot(f.velocity);
  return {{f.gap, gap_rate, f.stretch, f.velocity - gap_rate * f.n, f.bend, f.rolling, f.last_stretch,
           f.last_bend},
          f.normal,
          f.power(),
          f.energy,
          f.slides,
          f.rolls};
}

// Square of the rate of the point: friction that slides is no vibration [m2/s2].
double BodyContacts::Exchange::square(const ContactPoint& point) const {
  double sum = motion.gap_rate * motion.gap_rate;
  if (point.friction.stiffness > 0 && !slides) sum += motion.sliding.squaredNorm();
  if (const double radius = point.rolling.radius; radius > 0 && !rolls)
    sum += radius * radius * motion.rolling.squaredNorm();
  return sum;
}

// Work of a point on the links over a step, by Simpson's rule; in the middle of the step gap, stretch and
// bend are those of the cubics through both ends (energy_balance.hpp). A cubic is far from the motion where
// the step does not resolve the contact: then it is the mean of the forces at both ends, at the mean rate.
// Dampers have the force of that rate, so that they return no energy, and friction is bounded by the normal
// force that was there: a normal rate far below the mean one of the step counts in that of stiff dampers.
double BodyContacts::work(const ContactPoint& point, const Exchange& begin, const Exchange& end,
                          double h) const {
  if (!(h > 0)) return 0;
  const auto between = [&](const auto& x0, const auto& x1, const auto& v0, const auto& v1, auto& x, auto& v) {
    x = 0.5 * (x0 + x1) + h / 8 * (v0 - v1);
    v = 1.5 / h * (x1 - x0) - 0.25 * (v0 + v1);
  };
  const ContactMotion &m0 = begin.motion, &m1 = end.motion;
  if (h > growth * point.period / steps_per_vibration) {
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

// The end of a step of length h: contacts that have ended, and friction that slides. Returns whether an
// impact has ended that the step resolves.
bool BodyContacts::accept(State& state, double h) {
  const auto& links = system_.links();
  double longest = HUGE_VAL;
  const bool any = !state.contacts.empty();
  bool impact_ended = false;
  extremes_ = {};
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    Candidate& candidate = candidates_[i];
    if (candidate.point < 0) continue;
    const Eigen::Index index = candidate.point;
    auto& point = state.contacts[index];
    const ContactLaw law = model_.contact.law(candidate.feature.a, candidate.feature.b);
    const ContactForce f = evaluate(model_, point, links, Derivatives::without);
    const Exchange& begin = at_begin_[static_cast<std::size_t>(index)];
    const double done = work(point, begin, at_end_[static_cast<std::size_t>(index)], h);
    const int shape_a = candidate.feature.a, shape_b = candidate.feature.b;
    extremes_.force = std::max(extremes_.force, f.normal);
    if (const double share = -f.gap / thickness_at(model_, candidate.feature); share > extremes_.depth_share)
      extremes_.depth_share = share, extremes_.shape_a = shape_a, extremes_.shape_b = shape_b;
    const bool open = f.gap > 0;
    if (open && !returns_faintly(candidate.feature, f.gap, gaps_[i].rate)) {
      lose(begin.energy - done, shape_a, shape_b);
      candidate.point = -1;
      impact_ended |= h <= coarsest * point.period / steps_per_contact &&
                      !is_faint(candidate.feature, gaps_[i].rate, -gaps_before_[i].value);
      continue;
    }
    kept.push_back(index);
    if (begin.motion.gap > candidate.tolerance && !open) ++counters_.contacts;
    const Exchange& end = at_end_[static_cast<std::size_t>(index)];
    if (law.hertz) point.period = period(point, -f.gap);
    const double since = state.time - point.entry_time,
                 entry_rate = since <= point.period ? point.entry_rate : 0;
    if (open)
      point.entry_rate = std::min(point.entry_rate, std::abs(gaps_[i].rate));
    else if (is_impact(state, point, end))
      longest =
          std::min(longest, impact_step(point, since, std::max(entry_rate, std::sqrt(end.square(point)))));
    else if (vibrates(point, end))
      longest = std::min(longest, point.period / steps_per_vibration);

    const double stored = normal_energy(law, -f.gap) + move_spring(f, point) + move_rolling_spring(f, point);
    if (law.hertz) point.last_depth = std::max(0.0, -f.gap);
    lose(begin.energy - stored - done, shape_a, shape_b);
  }
  keep(state, kept);
  if (any) ++counters_.steps;
  double& touch_step = state.touch_step[0];
  if (touch_step == 0 && longest == HUGE_VAL) return impact_ended;
  touch_step = std::min(touch_step > 0 ? growth * touch_step : HUGE_VAL, longest);
  if (touch_step >= requested_) touch_step = 0;
  return impact_ended;
}

// Before a step of length h, moves the ends of the springs of friction of round surfaces to where the point
// of contact will be in the middle of the step, and keeps their stretch. The ends are in the two bodies; a
// spin about the normal moves them past each other where the point of contact is elsewhere, which is no
// sliding. Over the step this cancels.
void BodyContacts::aim_springs(State& state, double h) const {
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    if (!(state.contacts[k].friction.stiffness > 0)) continue;
    auto& point = state.contacts[k];
    const ContactFeature feature = point.feature;
    const double radius =
        std::max(model_.contact.shape(feature.a).radius, model_.contact.shape(feature.b).radius);
    if (!(radius > 0)) continue;
    const LinkMotion &a = link_of(model_, feature.a, system_.links()),
                     &b = link_of(model_, feature.b, system_.links());
    const Touch t = touch(model_, feature, system_.links(), Derivatives::with);
    const auto across = [&](const Vector3d& x) { return Vector3d(x - t.n.dot(x) * t.n); };
    const Vector3d rate = t.dp_a * a.V + t.dp_b * b.V - 0.5 * (at_point(a.V, t.p) + at_point(b.V, t.p)),
                   middle = t.p + 0.5 * h * across(rate);
    if (!(across(middle - a.point(point.friction.on_a)).norm() > rolled * radius)) continue;
    const Vector3d stretch = evaluate(model_, point, system_.links(), Derivatives::without).spring_stretch();
    point.friction.on_a = in_link(a, middle);
    point.friction.on_b = in_link(b, middle + stretch);
  }
}

// The same for the directions of the springs of rolling friction: each turns with the spin of its body where
// it is not along the normal, which is no rolling. In the middle of the step they are along the normal as
// seen from the body that spins, or from between both.
void BodyContacts::aim_rolling_springs(State& state, double h) const {
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    if (!(state.contacts[k].rolling.stiffness > 0)) continue;
    auto& point = state.contacts[k];
    const ContactFeature feature = point.feature;
    const LinkMotion &a = link_of(model_, feature.a, system_.links()),
                     &b = link_of(model_, feature.b, system_.links());
    const Touch t = touch(model_, feature, system_.links(), Derivatives::with);
    const Vector3d w_a = a.V.head<3>(), w_b = b.V.head<3>(), rate = t.dn_a * a.V + t.dn_b * b.V;
    const double spin_a = std::abs(t.n.dot(w_a)), spin_b = std::abs(t.n.dot(w_b));
    if (!(spin_a + spin_b > 0)) continue;
    const Vector3d moved = (spin_a * w_a + spin_b * w_b).cross(t.n) / (spin_a + spin_b),
                   middle = (t.n + 0.5 * h * (rate - moved)).normalized();
    if (!((middle - a.R_WL * point.rolling.on_a).norm() > rolled)) continue;
    const Vector3d bend = evaluate(model_, point, system_.links(), Derivatives::without).bend;
    set_rolling_spring(middle, middle + bend.cross(t.n), a, b, point);
  }
}

// Moves the ends of the spring of friction where it slides: to the stretch that has the friction with which
// the step ended, without its damping. Returns the energy of the spring [J].
double BodyContacts::move_spring(const ContactForce& f, ContactPoint& point) const {
  const auto& links = system_.links();
  const ContactShape &a = model_.contact.shape(point.feature.a), &b = model_.contact.shape(point.feature.b);
  const LinkMotion &link_a = links[static_cast<std::size_t>(a.link)],
                   &link_b = links[static_cast<std::size_t>(b.link)];
  const ContactLaw law = model_.contact.law(point.feature.a, point.feature.b);
  const AlongFactors along = along_factors(law, point, -f.gap);
  const double stiffness = along.stiffness * point.friction.stiffness;
  const bool slips = f.slides || f.normal == 0;
  Vector3d stretch = f.spring_stretch();
  if (slips) {
    const Vector3d v_t = f.velocity - f.n.dot(f.velocity) * f.n;
    stretch = left_over(f.friction, along.damping * point.friction.damping * v_t, stiffness);
    point.friction.on_a = in_link(link_a, f.p);
    point.friction.on_b = in_link(link_b, f.p + stretch);
  } else if (f.stiffer > 0) {
    const Vector3d on_b = link_b.point(point.friction.on_b);
    point.friction.on_b = in_link(link_b, on_b - f.stiffer * f.last_stretch);
  }
  if (law.hertz) point.friction.last_stretch = link_a.R_WL.transpose() * stretch;
  return 0.5 * stiffness * stretch.squaredNorm();
}

// The same for the spring of rolling friction.
double BodyContacts::move_rolling_spring(const ContactForce& f, ContactPoint& point) const {
  if (!(point.rolling.stiffness > 0)) return 0;
  const ContactLaw law = model_.contact.law(point.feature.a, point.feature.b);
  const AlongFactors along = along_factors(law, point, -f.gap);
  const double stiffness = along.stiffness * point.rolling.stiffness;
  const LinkMotion &a = link_of(model_, point.feature.a, system_.links()),
                   &b = link_of(model_, point.feature.b, system_.links());
  const bool slips = f.rolls || f.normal == 0;
  const Vector3d bend =
      slips ? left_over(f.torque, along.damping * point.rolling.damping * f.rolling, stiffness)
            : f.spring_bend();
  const Vector3d direction = a.R_WL * point.rolling.on_a;
  if (slips || f.stiffer > 0 || (direction - f.n).norm() > turned)
    set_rolling_spring(f.n, (f.n + bend.cross(f.n)).normalized(), a, b, point);
  if (law.hertz) point.rolling.last_bend = a.R_WL.transpose() * bend;
  return 0.5 * stiffness * bend.squaredNorm();
}

// Of an impact as deep as the point was at the most, now or before [s].
double BodyContacts::period(const ContactPoint& point, double depth) const {
  const double before = point.period;
  const ContactLaw law = model_.contact.law(point.feature.a, point.feature.b);
  if (!law.hertz || !(depth > 0)) return before;
  return std::min(before, half_period(law, point.mass, depth));
}

// Whether steps resolve an impact of this point: for its duration, and for as long as it bounces after that.
bool BodyContacts::is_impact(const State& state, const ContactPoint& point, const Exchange& now) const {
  const double since = state.time - point.entry_time, period = point.period;
  if (since > lasting * period || is_within_steps(point)) return false;
  const double rate = point.entry_rate, least = faint_square(point.feature.a, point.feature.b);
  return (since <= period && rate * rate > least) || now.square(point) > least;
}

// A load that jumps makes a body vibrate on its contacts. A step that does not resolve this has another
// energy, and dampers at the points take another part of it.
bool BodyContacts::vibrates(const ContactPoint& point, const Exchange& now) const {
  if (is_within_steps(point)) return false;
  return 0.5 * point.mass * now.square(point) > least_vibration * energy_scale_;
}

}  // namespace tandem::mbd
