#include "mbd_server/step/contact_rules.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "mbd_server/forces/joint_force.hpp"

namespace tandem::mbd {
namespace {

// An impact is faint where its rate is that of a fall through this share of the size of the body, and its
// material loses half of the energy in an impact: what the steps leave out does not add up then.
constexpr double faint_fall = 1e-6, most_elastic = 0.7;
// The begin of a contact is found to this share of the depth under the weight of the body.
constexpr double weight_share = 0.01;
// A contact vibrates where the energy of its rate is more than this share of the energy that moves.
constexpr double least_vibration = 1e-6;
// An impact of much damping loses most of its rate in a part of this share of its duration: steps there are
// shorter.
constexpr double sudden = 0.125;
// The steps of an impact grow from that multiple of the energy of a faint impact.
constexpr double coarser_from = 1e3;
// Impacts that end again last one to some durations of one without loads.
constexpr double lasting = 10;
// Points of so many pairs are many.
constexpr std::ptrdiff_t crowd = 8;

// Joints and other bodies only add to it.
double least_mass(const Model& model, const ContactShape& shape) {
  const Link& link = model.links[static_cast<std::size_t>(shape.link)];
  if (!(link.mass > 0) || shape.kind == ContactShape::Kind::plane) return 0;
  const double inertia = Eigen::SelfAdjointEigenSolver<Matrix3d>(link.inertia).eigenvalues()[0],
               lever = (shape.centre - link.com).norm() + shape.bound;
  return 1 / (1 / link.mass + lever * lever / inertia);
}

}  // namespace

ContactRules::ContactRules(const Model& model)
    : model_(model), tolerance_(1e-10 * model.size), least_(1e-14 * model.size) {
  const double g = model.gravity.norm();
  for (const ContactShape& shape : model.contact.shapes) {
    const bool moves = shape.body != none;
    const double mass = moves ? model.bodies[static_cast<std::size_t>(shape.body)].mass : HUGE_VAL;
    const double square = moves ? 2 * faint_fall * g * shape.bound : HUGE_VAL;
    faint_square_.push_back(square);
    faint_energy_.push_back(moves ? 0.5 * mass * square : HUGE_VAL);
    least_masses_.push_back(shape.link == 0 ? HUGE_VAL : least_mass(model, shape));
    weights_.push_back(moves ? mass * g : HUGE_VAL);
  }
}

double ContactRules::tolerance(const ContactFeature& f) const {
  const double weight =
      std::min(weights_[static_cast<std::size_t>(f.a)], weights_[static_cast<std::size_t>(f.b)]);
  if (!(weight > 0)) return tolerance_;
  return std::clamp(weight_share * depth_of(model_.contact.law(f.a, f.b), weight), least_, tolerance_);
}

bool ContactRules::is_elastic(int a, int b) const {
  static const double least = damping_number(most_elastic);
  return model_.contact.law(a, b).damping_number < least;
}

double ContactRules::faint_square(int a, int b) const {
  if (is_elastic(a, b)) return 0;
  return std::min(faint_square_[static_cast<std::size_t>(a)], faint_square_[static_cast<std::size_t>(b)]);
}

bool ContactRules::is_faint(const ContactFeature& f, double rate, double depth) const {
  if (is_within_steps(f)) return true;
  return rate * rate < faint_square(f.a, f.b) && normal_energy(model_.contact.law(f.a, f.b), depth) <=
                                                     std::min(faint_energy_[static_cast<std::size_t>(f.a)],
                                                              faint_energy_[static_cast<std::size_t>(f.b)]);
}

bool ContactRules::returns_faintly(const ContactFeature& f, double gap, double rate) const {
  return !f.on_mesh && rate * rate + 2 * model_.gravity.norm() * gap < faint_square(f.a, f.b);
}

bool is_crowd(const std::vector<ContactPoint>& points) {
  std::vector<ShapePair> pairs;
  for (const ContactPoint& point : points) pairs.push_back(pair_of(point.feature));
  std::sort(pairs.begin(), pairs.end());
  return std::unique(pairs.begin(), pairs.end()) - pairs.begin() >= crowd;
}

void ContactRules::look_at(const std::vector<ContactPoint>& points, bool crowded) {
  crowded_ = crowded || is_crowd(points);
}

// Without the cut, the force that begins within a step acts as one that rises over the whole step: the error
// of its impulse is at most k (1 + c v) v h^2 / 8, a share (1 + c v) (pi h / period)^2 / 8 of m v.
double ContactRules::uncut_step(const ContactFeature& f, double rate) const {
  if (!may_pass(f)) return 0;
  const double mass = 1 / (1 / least_masses_[static_cast<std::size_t>(f.a)] +
                           1 / least_masses_[static_cast<std::size_t>(f.b)]);
  if (!(mass > 0)) return 0;
  const ContactLaw law = model_.contact.law(f.a, f.b);
  return half_period(law, mass, std::max(tolerance_, impact_depth(law, mass, rate))) / steps_uncut;
}

double ContactRules::uncut_step(const ContactPoint& point) const {
  return may_pass(point.feature) ? point.period / steps_uncut : 0;
}

bool ContactRules::may_pass(const ContactFeature& f) const {
  return crowded_ && !f.on_mesh && !is_within_steps(f) && !is_elastic(f.a, f.b);
}

bool ContactRules::may_begin(const ContactFeature& f, double gap, double rate, double h) const {
  return gap <= tolerance(f) + 2 * h * std::max(0.0, -rate) + h * h * model_.gravity.norm();
}

double ContactRules::period(const ContactPoint& point, double depth) const {
  const ContactLaw law = model_.contact.law(point.feature.a, point.feature.b);
  if (!law.hertz || !(depth > 0)) return point.period;
  return std::min(point.period, half_period(law, point.mass, depth));
}

double ContactRules::impact_step(const ContactPoint& point, double since, double rate) const {
  const int a = point.feature.a, b = point.feature.b;
  const double number = model_.contact.law(a, b).damping_number, fast = coarser_from * faint_square(a, b);
  double step = point.period / steps_per_contact;
  if (rate * rate < fast) step *= rate > 0 ? std::min(coarsest, std::sqrt(fast) / rate) : 1;
  return since < sudden * point.period ? step / std::sqrt(1 + 0.5 * number) : step;
}

bool ContactRules::is_impact(double time, const ContactPoint& point, const ContactExchange& now) const {
  const double since = time - point.entry_time, rate = point.entry_rate;
  if (since > lasting * point.period || is_within_steps(point.feature)) return false;
  const double least = faint_square(point.feature.a, point.feature.b);
  return (since <= point.period && rate * rate > least) || now.square(point) > least;
}

bool ContactRules::vibrates(const ContactPoint& point, const ContactExchange& now) const {
  if (is_within_steps(point.feature)) return false;
  return 0.5 * point.mass * now.square(point) > least_vibration * energy_scale_;
}

double ContactExchange::square(const ContactPoint& point) const {
  double sum = motion.gap_rate * motion.gap_rate;
  if (point.friction.stiffness > 0 && !slides) sum += motion.sliding.squaredNorm();
  if (const double radius = point.rolling.radius; radius > 0 && !rolls)
    sum += radius * radius * motion.rolling.squaredNorm();
  return sum;
}

}  // namespace tandem::mbd
