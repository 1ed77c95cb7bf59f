#include "mbd_server/solve/redundancy.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace tandem::mbd {
namespace {

// An equation is a candidate if the sine of its angle to those before it is below this.
constexpr double candidate = 0.1;
// An equation that opens by this share of its path is independent. The smaller share suffices where the share
// grows along the path, as it does when leaving a singular position; where data do not fit, it is constant.
constexpr double clearly_open = 0.03, growing_open = 5e-3, share_growth = 3;
// An equation that opens by a smaller share, but beyond the tolerance, is not meant as an independent one.
constexpr double hardly_open = 3e-3;
// A loop that moves by less than this share of its motion without an equation is locked by that equation.
constexpr double locked_share = 1e-3;
constexpr int max_rounds = 32, directions = 3, steps = 8, closing_iterations = 10;
constexpr double step_length = 0.05;  // of the largest coordinate [rad, or relative to its scale]
// A loop that has moved by less is not tested [-].
constexpr double least_travel = 1e-3;

class Finder {
 public:
  Finder(const Model& model, MachineSystem& system, const State& start, double tolerance)
      : model_(model),
        system_(system),
        start_(start),
        tolerance_(tolerance),
        out_(static_cast<std::size_t>(model.equations), false),
        share_(out_.size()),
        opening_(out_.size()),
        first_share_(out_.size()),
        zero_(VectorXd::Zero(model.freedoms)),
        x_(zero_),
        lambda_(VectorXd::Zero(model.equations)) {}

  Redundancy find() {
    if (model_.freedoms == 0) return all();
    find_candidates();
    for (int round = 0; round < max_rounds && !candidates_.empty(); ++round) {
      measure();
      const int widest = *std::max_element(candidates_.begin(), candidates_.end(),
                                           [&](int a, int b) { return share_[a] < share_[b]; });
      if (!independent(widest)) break;
      candidates_.erase(std::find(candidates_.begin(), candidates_.end(), widest));
      out_[widest] = false;
    }
    return classify();
  }

 private:
  // In a machine that is wholly driven, no equation can adapt the motion: the prescribed motions have to
  // satisfy them all.
  Redundancy all() const {
    Redundancy r;
    for (int e = 0; e < model_.equations; ++e) r.equations.push_back(e);
    for (const Closure& c : model_.closures) r.rows.push_back(c.size());
    return r;
  }

  const VectorXd& phi() { return system_.constraint(Level::position); }

  void find_candidates() {
    system_.residual(start_);
    system_.factorise_geometry(candidate, out_);
    candidates_ = system_.dependent();
    std::sort(candidates_.begin(), candidates_.end());
    for (const int e : candidates_) out_[e] = true;
    at_start_ = phi();
    // Where no motion can decide, an equation within the tolerance counts as redundant.
    system_.factorise_geometry(tolerance_, std::vector<bool>(out_.size(), false));
    within_ = system_.dependent();
    // The bound decides which equations of a dependent set are left out.
    if (within_.size() >= candidates_.size()) within_ = candidates_;
  }

  bool independent(int e) const {
    return share_[e] >= clearly_open ||
           (share_[e] >= growing_open && share_[e] > share_growth * first_share_[e]);
  }

  // Measures the opening of the candidates along a few motions of the machine.
  void measure() {
    std::fill(share_.begin(), share_.end(), -1.0);
    std::fill(first_share_.begin(), first_share_.end(), 0.0);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < directions; ++i) {
      VectorXd direction(model_.freedoms);
      for (double& d : direction) d = normal(random);
      follow(direction);
    }
  }

  void follow(VectorXd direction) {
    State state = start_;
    std::vector<Eigen::Vector2d> travel(model_.closures.size(), Eigen::Vector2d::Zero());
    for (int i = 0; i < steps; ++i) {
      system_.residual(state);
      system_.factorise_geometry(0, out_);
      system_.elimination().weigh_geometry(direction);
      system_.solve(direction, VectorXd::Zero(model_.equations), x_, lambda_);
      const double longest = x_.cwiseQuotient(model_.scale).cwiseAbs().maxCoeff();
      if (!(longest > 1e-9)) return;
      x_ *= step_length / longest;
      direction = x_;
      move(state, x_);
      if (!close(state)) return;
      system_.elimination().add_travel(direction, travel);
      record(travel, i == 0);
    }
  }

  void move(State& state, const VectorXd& x) {
    const VectorXd q = state.q;
    system_.move(q, x, state.q);
  }

  bool close(State& state) {
    for (int i = 0; i < closing_iterations; ++i) {
      system_.residual(state);
      system_.factorise_geometry(0, out_);
      system_.solve(zero_, phi(), x_, lambda_);
      const double size = system_.norm(x_);
      if (!std::isfinite(size) || size > 1) return false;
      move(state, -x_);
      if (size < 1e-12) {
        system_.residual(state);
        return true;
      }
    }
    return false;
  }

  void record(const std::vector<Eigen::Vector2d>& travel, bool first) {
    for (std::size_t k = 0; k < model_.closures.size(); ++k) {
      const Closure& c = model_.closures[k];
      for (int j = 0; j < c.size(); ++j) {
        const int e = c.first + j;
        if (!out_[e]) continue;
        const bool torque = is_torque(c.equations[j].kind);
        const double way = travel[k][torque ? 1 : 0];
        if (way < least_travel * (torque ? 1 : c.reach)) continue;
        const double opening = std::abs(phi()[e] - at_start_[e]);
        const double share = opening / way;
        if (first) first_share_[e] = std::max(first_share_[e], share);
        if (share > share_[e]) share_[e] = share, opening_[e] = opening;
      }
    }
  }

  Redundancy classify() {
    Redundancy r;
    std::vector<int> doubtful;
    r.rows.assign(model_.closures.size(), 0);
    for (const int e : candidates_) {
      const bool untried = share_[e] < 0;
      if (untried && std::find(within_.begin(), within_.end(), e) == within_.end()) continue;
      if (independent(e)) continue;
      if (share_[e] > tolerance_) {
        doubtful.push_back(e);
        continue;
      }
      r.equations.push_back(e);
      ++r.rows[closure_of(e)];
    }
    for (const int e : doubtful)
      if (share_[e] > r.contradiction.share && (share_[e] < hardly_open || locks(doubtful, closure_of(e))))
        r.contradiction = {e, opening_[e], share_[e]};
    return r;
  }

  std::size_t closure_of(int e) const {
    std::size_t k = 0;
    while (e >= model_.closures[k].first + model_.closures[k].size()) ++k;
    return k;
  }

  // Whether these equations, when they are kept closed, leave the loop of a closure no motion.
  bool locks(const std::vector<int>& equations, std::size_t closure) {
    std::vector<bool> out = out_;
    const double with_all = travel_along(out)[closure];
    for (const int e : equations) out[e] = false;
    return travel_along(out)[closure] < locked_share * with_all;
  }

  // Path of the closures in a random motion at the start that satisfies all equations that are not left
  // out.
  std::vector<double> travel_along(const std::vector<bool>& out) {
    system_.residual(start_);
    system_.factorise_geometry(0, out);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    VectorXd direction(model_.freedoms);
    for (double& d : direction) d = normal(random);
    system_.elimination().weigh_geometry(direction);
    system_.solve(direction, VectorXd::Zero(model_.equations), x_, lambda_);
    std::vector<Eigen::Vector2d> travel(model_.closures.size(), Eigen::Vector2d::Zero());
    system_.elimination().add_travel(x_, travel);
    std::vector<double> sizes;
    for (std::size_t k = 0; k < travel.size(); ++k)
      sizes.push_back(travel[k][0] / model_.closures[k].reach + travel[k][1]);
    return sizes;
  }

  const Model& model_;
  MachineSystem& system_;
  const State& start_;
  double tolerance_;
  std::vector<bool> out_;  // candidates that do not take part (equations)
  std::vector<int> candidates_, within_;
  std::vector<double> share_, opening_;  // -1: not tried (equations)
  std::vector<double> first_share_;      // after the first step (equations)
  VectorXd at_start_;                    // phi (equations)
  VectorXd zero_, x_, lambda_;
};

}  // namespace

Redundancy find_redundancy(const Model& model, MachineSystem& system, const State& start, double tolerance) {
  return Finder(model, system, start, tolerance).find();
}

}  // namespace tandem::mbd
