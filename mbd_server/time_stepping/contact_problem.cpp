#include "mbd_server/time_stepping/contact_problem.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/model/indices.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {
namespace {

// Of the scaled gradient, over the momenta: of a minimum, and of the bounds of friction.
constexpr double tolerance_of_minimum = 1e-6, tolerance_of_bounds = 1e-4, tolerance_of_first = 0.1,
                 share_of_misfit = 0.4;
// Below it Newton's method with bounds that follow is tried.
constexpr double largest_to_fit = 0.02, least_progress = 0.5;
constexpr int most_iterations = 100, most_minima = 16;
// Conjugate gradients leave an error of the direction that stiff contacts enlarge: where so many iterations
// of Newton's method with them find no minimum, it begins anew and factorises.
constexpr int most_with_gradients = 12;
// Of the slope along the direction of a Newton step, over that at its begin.
constexpr double tolerance_of_length = 0.01;
// Of the direction of a Newton step.
constexpr double tolerance_of_direction = 0.01;

Vector6d momentum_of(const ContactProblem::Body& body, const Vector6d& v) {
  return spatial(body.inertia * v.head<3>(), body.mass * v.tail<3>());
}

// Sum over the bodies of p^T D^2 q, where D^2 is the inverse of the diagonal of M [Castro2022].
double scaled(const ContactProblem::Body& body, const Vector6d& p) {
  return p.head<3>().cwiseAbs2().cwiseQuotient(body.inertia.diagonal()).sum() +
         p.tail<3>().squaredNorm() / body.mass;
}

// Of a wrench on one body at r by the velocity of another at s: [r x G (w x s + v); G (w x s + v)].
Matrix6d at_points(const Vector3d& r, const Matrix3d& G, const Vector3d& s) {
  Matrix6d m;
  for (int i = 0; i < 3; ++i) m.block<1, 3>(3 + i, 0) = s.cross(G.row(i).transpose()).transpose();
  m.bottomRightCorner<3, 3>() = G;
  for (int k = 0; k < 6; ++k) m.block<3, 1>(0, k) = r.cross(m.block<3, 1>(3, k));
  return m;
}

}  // namespace

ContactProblem::Effort ContactProblem::solve(double h) {
  h_ = h;
  is_stiff_ = false;
  connect();
  Effort effort;
  evaluate();
  // The bounds of a minimum that is not the last one need no more digits than they have.
  double misfit = tolerance_of_first;
  do {
    minimise(share_of_misfit * misfit, effort);
    ++effort.minima;
    evaluate(Bounds::fitted);
    bool fits = misfit_ < largest_to_fit;
    while (fits && misfit_ > tolerance_of_bounds) fits = fit_bounds(effort);
    misfit = misfit_;
    effort.settled = misfit <= tolerance_of_bounds;
  } while (!effort.settled && static_cast<int>(effort.minima) < most_minima);
  minimise(tolerance_of_minimum, effort);
  return effort;
}

void ContactProblem::connect() {
  std::vector<BlockMatrix::Pair>& pairs = matrix_.pairs;
  pairs.clear();
  for (const Point& p : points)
    if (p.a != none && p.b != none) pairs.emplace_back(std::minmax(p.a, p.b));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  pair_of_.clear();
  for (const Point& p : points) {
    const auto found = std::lower_bound(pairs.begin(), pairs.end(), BlockMatrix::Pair(std::minmax(p.a, p.b)));
    pair_of_.push_back(p.a != none && p.b != none ? static_cast<int>(found - pairs.begin()) : none);
  }
  matrix_.diagonal.resize(bodies.size());
  matrix_.upper.resize(pairs.size());
  impulses_.resize(points.size());
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

double ContactProblem::normal_at(const Point& p, const Vector3d& velocity) const {
  const double v_n = p.n.dot(velocity), depth = p.depth - h_ * v_n, grip = 1 - p.damping * v_n;
  return depth > 0 && grip > 0 ? h_ * p.stiffness * depth * grip : 0;
}

template <ContactProblem::Slopes slopes>
ContactProblem::Impulse ContactProblem::impulse_at(const Point& p, const Vector3d& velocity) const {
  constexpr bool with_slopes = slopes == Slopes::with;
  const double v_n = p.n.dot(velocity);
  Impulse of;
  of.normal = normal_at(p, velocity);
  if (with_slopes && of.normal > 0) {
    const double depth = p.depth - h_ * v_n, grip = 1 - p.damping * v_n;
    of.normal_slope = h_ * p.stiffness * (h_ * grip + p.damping * depth);
    of.slope.noalias() = (of.normal_slope * p.n) * p.n.transpose();
  }
  if (!(p.bound > 0)) return of;
  const Vector3d force = p.stretch + h_ * (velocity - v_n * p.n);
  of.tangential = -h_ * p.along * force;
  const double size = of.tangential.norm(), k = h_ * h_ * p.along;
  const bool slides = size > p.bound;
  const double share = slides ? p.bound / size : 1;
  if (with_slopes) {
    of.slope.diagonal().array() += share * k;
    of.slope.noalias() -= (share * k * p.n) * p.n.transpose();
    if (slides) {
      of.slope.noalias() -= (share * k / (size * size) * of.tangential) * of.tangential.transpose();
      of.slip = of.tangential / size;
    }
  }
  of.tangential *= share;
  return of;
}

void ContactProblem::evaluate(Bounds bounds) {
  double of_gradient = 0, of_momenta = 0, of_impulses = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) gradient_[i].setZero(), v_[i] = bodies[i].v;
  for (std::size_t k = 0; k < points.size(); ++k) {
    Point& p = points[k];
    p.velocity = velocity_at(p, v_) + p.given;
    if (bounds == Bounds::fitted) p.bound = p.friction * normal_at(p, p.velocity);
    impulses_[k] = impulse_at<Slopes::with>(p, p.velocity);
    p.normal = impulses_[k].normal, p.tangential = impulses_[k].tangential;
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
  misfit_ = scale > 0 ? std::sqrt(of_gradient / scale) : 0;
}

// A step of Newton's method with bounds that follow the normal impulses: its matrix is not symmetric, and no
// function falls along it. Returns false, and changes nothing, where it does not halve the misfit.
bool ContactProblem::fit_bounds(Effort& effort) {
  if (is_stiff_) return false;
  assemble();
  for (std::size_t i = 0; i < bodies.size(); ++i) direction_[i] = -gradient_[i];
  const auto add = [&](const std::vector<Vector6d>& x, std::vector<Vector6d>& y) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Point& p = points[k];
      const Impulse& of = impulses_[k];
      if (of.normal_slope == 0 || of.slip.isZero(0)) continue;
      const Vector3d impulse = (p.friction * of.normal_slope * p.n.dot(velocity_at(p, x))) * of.slip;
      if (p.b != none) y[as_index(p.b)] += wrench_at(p.r_b, impulse);
      if (p.a != none) y[as_index(p.a)] -= wrench_at(p.r_a, impulse);
    }
  };
  if (!iterative_.solve(matrix_, add, tolerance_of_direction, direction_)) return false;
  const double before = misfit_;
  const std::vector<Vector6d> start = v_;
  for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].v += direction_[k];
  ++effort.iterations;
  evaluate(Bounds::fitted);
  if (misfit_ <= least_progress * before) return true;
  for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].v = start[k];
  evaluate(Bounds::fitted);
  return false;
}

void ContactProblem::minimise(double tolerance, Effort& effort) {
  std::vector<Vector6d> start;
  for (const Body& body : bodies) start.push_back(body.v);
  for (int i = 0; misfit_ > tolerance; ++i) {
    if (i == most_iterations)
      throw Error(ErrorCode::numerics, "Newton's method finds no velocities at contacts between bodies",
                  "mbd_server", "give a shorter mbd.integrator.step");
    if (!is_stiff_ && i == most_with_gradients) {
      for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].v = start[k];
      evaluate();
      is_stiff_ = true;
    }
    assemble();
    find_direction(effort);
    const double length = step_length();
    for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].v += length * direction_[k];
    ++effort.iterations;
    evaluate();
  }
}

// H = M + sum of J^T G J.
void ContactProblem::assemble() {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Matrix6d& D = matrix_.diagonal[i];
    D.setZero();
    D.topLeftCorner<3, 3>() = bodies[i].inertia;
    D.bottomRightCorner<3, 3>().diagonal().setConstant(bodies[i].mass);
  }
  for (Matrix6d& block : matrix_.upper) block.setZero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point& p = points[k];
    if (impulses_[k].normal_slope == 0 && !(p.bound > 0)) continue;
    const Matrix3d& G = impulses_[k].slope;
    if (p.a != none) matrix_.diagonal[as_index(p.a)] += at_points(p.r_a, G, p.r_a);
    if (p.b != none) matrix_.diagonal[as_index(p.b)] += at_points(p.r_b, G, p.r_b);
    if (pair_of_[k] == none) continue;
    matrix_.upper[as_index(pair_of_[k])] -=
        p.a < p.b ? at_points(p.r_a, G, p.r_b) : at_points(p.r_b, G, p.r_a);
  }
}

// -H^-1 times the gradient.
void ContactProblem::find_direction(Effort& effort) {
  for (std::size_t i = 0; i < bodies.size(); ++i) direction_[i] = -gradient_[i];
  is_stiff_ = is_stiff_ || !iterative_.solve(matrix_, tolerance_of_direction, direction_);
  if (!is_stiff_) return;
  direct_.factorise(matrix_);
  direct_.solve(direction_);
  ++effort.factorisations;
}

// Where the function is least along the direction: a root of its slope, which rises. Newton's method between
// two bounds.
double ContactProblem::step_length() const {
  std::vector<Vector3d> changes;
  changes.reserve(points.size());
  for (const Point& p : points) changes.push_back(velocity_at(p, direction_));
  double at_begin = 0, inertial = 0, quadratic = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    at_begin += direction_[i].dot(gradient_[i]);
    inertial += direction_[i].dot(momentum_of(bodies[i], bodies[i].v - bodies[i].free));
    quadratic += direction_[i].dot(momentum_of(bodies[i], direction_[i]));
  }
  const auto slope_at = [&]<Slopes slopes>(double length, double& change) {
    double slope = inertial + length * quadratic;
    change = quadratic;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Impulse of = impulse_at<slopes>(points[k], points[k].velocity + length * changes[k]);
      slope -= (of.normal * points[k].n + of.tangential).dot(changes[k]);
      if (slopes == Slopes::with) change += changes[k].dot(of.slope * changes[k]);
    }
    return slope;
  };
  double change = 0, low = 0, high = HUGE_VAL, length = 1;
  const double most = tolerance_of_length * std::abs(at_begin);
  if (std::abs(slope_at.operator()<Slopes::without>(1, change)) <= most) return 1;
  for (int i = 0; i < 50; ++i) {
    const double slope = slope_at.operator()<Slopes::with>(length, change);
    if (std::abs(slope) <= most) break;
    (slope > 0 ? high : low) = length;
    const double newton = length - slope / change;
    length = newton > low && newton < high ? newton : high == HUGE_VAL ? 2 * length : 0.5 * (low + high);
  }
  return length;
}

}  // namespace tandem::mbd
