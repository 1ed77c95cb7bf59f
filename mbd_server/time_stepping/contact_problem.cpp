#include "mbd_server/time_stepping/contact_problem.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/model/indices.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {
namespace {

// Of the scaled gradient, over the momenta: of a minimum, and of the bounds of friction.
constexpr double tolerance_of_minimum = 1e-6, tolerance_of_bounds = 1e-4, tolerance_of_first = 1e-2,
                 share_of_misfit = 0.1;
constexpr int most_iterations = 100, most_minima = 16;
// Of the slope along the direction of a Newton step, over that at its begin.
constexpr double tolerance_of_length = 0.01;

Vector6d momentum_of(const ContactProblem::Body& body, const Vector6d& v) {
  return spatial(body.inertia * v.head<3>(), body.mass * v.tail<3>());
}

// Sum over the bodies of p^T D^2 q, where D^2 is the inverse of the diagonal of M [Castro2022].
double scaled(const ContactProblem::Body& body, const Vector6d& p) {
  return p.head<3>().cwiseAbs2().cwiseQuotient(body.inertia.diagonal()).sum() +
         p.tail<3>().squaredNorm() / body.mass;
}

// G of the velocity at r, of a wrench on one body by the velocity of another: [r x G (w x s + v); G (...)].
Matrix6d at_points(const Vector3d& r, const Matrix3d& G, const Vector3d& s) {
  const Matrix3d R = skew(r), Gs = G * skew(s);
  Matrix6d m;
  m << -R * Gs, R * G, -Gs, G;
  return m;
}

}  // namespace

ContactProblem::Effort ContactProblem::solve(double h) {
  h_ = h;
  connect();
  Effort effort;
  // The bounds of a minimum that is not the last one need no more digits than they have.
  double misfit = tolerance_of_first;
  do {
    minimise(share_of_misfit * misfit, effort);
    ++effort.minima;
    bound_friction();
    misfit = evaluate();
    effort.settled = misfit <= tolerance_of_bounds;
  } while (!effort.settled && static_cast<int>(effort.minima) < most_minima);
  minimise(tolerance_of_minimum, effort);
  return effort;
}

void ContactProblem::connect() {
  pairs_.clear();
  for (const Point& p : points)
    if (p.a != none && p.b != none) pairs_.emplace_back(std::minmax(p.a, p.b));
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  pair_of_.clear();
  for (const Point& p : points) {
    const auto found =
        std::lower_bound(pairs_.begin(), pairs_.end(), BlockCholesky::Pair(std::minmax(p.a, p.b)));
    pair_of_.push_back(p.a != none && p.b != none ? static_cast<int>(found - pairs_.begin()) : none);
  }
  slopes_.resize(points.size());
  gradient_.resize(bodies.size());
  v_.resize(bodies.size());
  direction_.resize(bodies.size());
}

Vector3d ContactProblem::velocity_at(const Point& p, const std::vector<Vector6d>& v) const {
  Vector3d sum = Vector3d::Zero();
  if (p.b != none) sum += v[as_index(p.b)].tail<3>() + v[as_index(p.b)].head<3>().cross(p.r_b);
  if (p.a != none) sum -= v[as_index(p.a)].tail<3>() + v[as_index(p.a)].head<3>().cross(p.r_a);
  return sum;
}

void ContactProblem::evaluate_at(Point& p, const Vector3d& velocity, Slope* slope) const {
  const double v_n = p.n.dot(velocity), depth = p.depth - h_ * v_n, grip = 1 - p.damping * v_n;
  p.velocity = velocity;
  p.normal = depth > 0 && grip > 0 ? h_ * p.stiffness * depth * grip : 0;
  p.tangential.setZero();
  p.slides = false;
  if (slope) {
    slope->normal = p.normal > 0 ? h_ * p.stiffness * (h_ * grip + p.damping * depth) : 0;
    slope->all = slope->normal * p.n * p.n.transpose();
  }
  if (!(p.bound > 0)) return;
  const Vector3d sliding = velocity - v_n * p.n;
  p.tangential = -h_ * p.along * (p.stretch + h_ * sliding);
  const double size = p.tangential.norm(), k = h_ * h_ * p.along;
  p.slides = size > p.bound;
  const double share = p.slides ? p.bound / size : 1;
  if (slope) {
    slope->all += share * k * (Matrix3d::Identity() - p.n * p.n.transpose());
    if (p.slides) slope->all -= share * k / (size * size) * p.tangential * p.tangential.transpose();
  }
  p.tangential *= share;
}

double ContactProblem::evaluate() {
  double of_gradient = 0, of_momenta = 0, of_impulses = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) gradient_[i].setZero(), v_[i] = bodies[i].v;
  for (std::size_t k = 0; k < points.size(); ++k) {
    Point& p = points[k];
    evaluate_at(p, velocity_at(p, v_) + p.given, &slopes_[k]);
    const Vector3d impulse = p.impulse();
    if (p.b != none) gradient_[as_index(p.b)] -= wrench_at(p.r_b, impulse);
    if (p.a != none) gradient_[as_index(p.a)] += wrench_at(p.r_a, impulse);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    of_impulses += scaled(body, gradient_[i]);
    of_momenta +=
        std::max(scaled(body, momentum_of(body, body.v)), scaled(body, momentum_of(body, body.free)));
    gradient_[i] += momentum_of(body, body.v - body.free);
    of_gradient += scaled(body, gradient_[i]);
  }
  const double scale = std::max(of_impulses, of_momenta);
  return scale > 0 ? std::sqrt(of_gradient / scale) : 0;
}

void ContactProblem::minimise(double tolerance, Effort& effort) {
  for (int i = 0; evaluate() > tolerance; ++i) {
    if (i == most_iterations)
      throw Error(ErrorCode::numerics, "Newton's method finds no velocities at contacts between bodies",
                  "mbd_server", "give a shorter mbd.integrator.step");
    find_direction();
    const double length = step_length();
    for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].v += length * direction_[k];
    ++effort.iterations, ++effort.factorisations;
  }
}

// -H^-1 times the gradient, H = M + sum of J^T G J.
void ContactProblem::find_direction() {
  matrix_.begin(static_cast<int>(bodies.size()), pairs_);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Matrix6d& D = matrix_.diagonal(static_cast<int>(i));
    D.topLeftCorner<3, 3>() = bodies[i].inertia;
    D.bottomRightCorner<3, 3>().diagonal().setConstant(bodies[i].mass);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point& p = points[k];
    if (slopes_[k].normal == 0 && !(p.bound > 0)) continue;
    const Matrix3d& G = slopes_[k].all;
    if (p.a != none) matrix_.diagonal(p.a) += at_points(p.r_a, G, p.r_a);
    if (p.b != none) matrix_.diagonal(p.b) += at_points(p.r_b, G, p.r_b);
    if (pair_of_[k] == none) continue;
    const bool in_order = p.a < p.b;
    matrix_.add(as_index(pair_of_[k]),
                in_order ? Matrix6d(-at_points(p.r_a, G, p.r_b)) : Matrix6d(-at_points(p.r_b, G, p.r_a)));
  }
  matrix_.factorise();
  for (std::size_t i = 0; i < bodies.size(); ++i) direction_[i] = -gradient_[i];
  matrix_.solve(direction_);
}

// Where the function is least along the direction: a root of its slope, which rises. Newton's method between
// two bounds.
double ContactProblem::step_length() const {
  struct Along {
    const Point* point;
    Vector3d change;
  };
  std::vector<Along> moving;
  for (const Point& p : points) moving.push_back({&p, velocity_at(p, direction_)});
  double inertial = 0, quadratic = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    inertial += direction_[i].dot(momentum_of(bodies[i], bodies[i].v - bodies[i].free));
    quadratic += direction_[i].dot(momentum_of(bodies[i], direction_[i]));
  }
  const auto slope_at = [&](double length, double* change = nullptr) {
    double slope = inertial + length * quadratic;
    if (change) *change = quadratic;
    for (const Along& one : moving) {
      Point p = *one.point;
      Slope of;
      evaluate_at(p, p.velocity + length * one.change, change ? &of : nullptr);
      slope -= p.impulse().dot(one.change);
      if (change) *change += one.change.dot(of.all * one.change);
    }
    return slope;
  };
  double change = 0, low = 0, high = HUGE_VAL, length = 1;
  const double most = tolerance_of_length * std::abs(slope_at(0));
  if (std::abs(slope_at(1)) <= most) return 1;
  for (int i = 0; i < 50; ++i) {
    const double slope = slope_at(length, &change);
    if (std::abs(slope) <= most) break;
    (slope > 0 ? high : low) = length;
    const double newton = length - slope / change;
    length = newton > low && newton < high ? newton : high == HUGE_VAL ? 2 * length : 0.5 * (low + high);
  }
  return length;
}

void ContactProblem::bound_friction() {
  for (Point& p : points) p.bound = p.friction * p.normal;
}

}  // namespace tandem::mbd
