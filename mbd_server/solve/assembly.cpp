#include "mbd_server/solve/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

constexpr MatrixWeights mass_only{.mass = 1, .damping = 0, .stiffness = 0};
constexpr int max_iterations = 100;
// Longest correction of one iteration: 0.3 rad, or that share of the size.
constexpr double longest = 0.3;
constexpr double converged = 1e-13;

// The equation that is furthest from zero.
int worst(const VectorXd& phi) {
  Eigen::Index i = 0;
  phi.cwiseAbs().maxCoeff(&i);
  return static_cast<int>(i);
}

class Assembler {
 public:
  Assembler(const scene::Scene& scene, const Model& model, MachineSystem& system, State& state)
      : scene_(scene),
        model_(model),
        system_(system),
        state_(state),
        zero_(VectorXd::Zero(model.freedoms)),
        dx_(zero_),
        dlambda_(VectorXd::Zero(model.equations)) {}

  AssemblyReport run() {
    report_.degrees_of_freedom = model_.freedoms;
    if (model_.equations == 0) return report_;
    close_loops();
    check_idle();
    find_redundant();
    fit_rates();
    return report_;
  }

 private:
  void factorise(const std::vector<int>* hold = nullptr) { system_.factorise(mass_only, zero_, hold); }

  void close_loops() {
    const std::vector<Vector3d> before = positions();
    VectorXd q = state_.q;
    for (int i = 0;; ++i) {
      system_.residual(state_);
      factorise();
      system_.solve(zero_, system_.constraint(Level::position), dx_, dlambda_);
      const double size = system_.norm(dx_);
      if (size <= converged) break;
      if (i == max_iterations || !std::isfinite(size)) refuse_open_loop();
      dx_ *= -std::min(1.0, longest / size);
      q = state_.q;
      system_.move(q, dx_, state_.q);
    }
    // What dependent equations ask for cannot be met by any motion that the others allow.
    const VectorXd& phi = system_.constraint(Level::position);
    if (std::abs(phi[worst(phi)]) > 1e-9 * std::max(1.0, model_.size)) refuse_open_loop();
    const std::vector<Vector3d> after = positions();
    for (std::size_t b = 0; b < after.size(); ++b) {
      const double distance = (after[b] - before[b]).norm();
      if (distance > report_.distance) report_.distance = distance, report_.moved_body = static_cast<int>(b);
    }
    const double tolerance = scene_.mbd->integrator.assembly_tolerance * model_.size;
    if (report_.distance > tolerance)
      throw Error(
          ErrorCode::scene,
          fmt::format("the loops are open at the start: closing them would move body \"{}\" by {:.3g} m, "
                      "and others by less",
                      scene_.mbd->bodies[static_cast<std::size_t>(report_.moved_body)].name,
                      report_.distance),
          "mbd.bodies",
          fmt::format("correct the positions, or give mbd.integrator.assembly_tolerance = {:.2g} or more",
                      1.01 * report_.distance / model_.size));
    if (report_.distance < 1e-12 * model_.size) report_.moved_body = none;
  }

  // Equations that no motion of the machine changes.
  void check_idle() {
    for (const Closure& c : model_.closures)
      for (const Equation& e : c.idle) {
        const double open = std::abs(evaluate(c, e, system_.links()).position);
        if (open > 1e-9 * std::max(1.0, model_.size)) refuse_open_loop(c.name + ": " + e.what, open);
      }
  }

  [[noreturn]] void refuse_open_loop() {
    const VectorXd& phi = system_.constraint(Level::position);
    const int e = worst(phi);
    refuse_open_loop(equation_name(model_, e), std::abs(phi[e]));
  }
  [[noreturn]] void refuse_open_loop(const std::string& name, double open) {
    throw Error(ErrorCode::scene,
                fmt::format("the loops cannot be closed: {} stays open by {:.3g}", name, open), "mbd.joints",
                "check lengths and positions of the bodies in this loop");
  }

  // Bodies as the file has them, or as a motion places them.
  std::vector<Vector3d> positions() {
    system_.residual(state_);
    std::vector<Vector3d> points;
    for (const BodyOnLink& b : model_.bodies) points.push_back(system_.links()[b.link].point(b.p_LB));
    return points;
  }

  void find_redundant() {
    system_.residual(state_);
    factorise();
    std::vector<int> dependent = system_.dependent();
    std::sort(dependent.begin(), dependent.end());
    for (const Closure& c : model_.closures)
      for (const Equation& e : c.idle) report_.redundant.push_back(c.name + ": " + e.what);
    for (const int equation : dependent) report_.redundant.push_back(equation_name(model_, equation));
    report_.degrees_of_freedom += static_cast<int>(dependent.size()) - model_.equations;
    system_.reserve_null_space(std::min<std::size_t>(dependent.size() + 4, 64));
  }

  // The smallest change of rates, in the metric of the masses, that keeps those which the scene gives.
  void fit_rates() {
    const VectorXd given = state_.u;
    for (int i = 0; i < 3; ++i) {
      system_.residual(state_);
      factorise(&model_.held);
      system_.solve(zero_, system_.constraint(Level::velocity), dx_, dlambda_);
      state_.u -= dx_;
    }
    system_.residual(state_);
    const VectorXd& rate = system_.constraint(Level::velocity);
    const int e = worst(rate);
    const double fast = std::max(1e-12, given.cwiseAbs().maxCoeff());
    const auto refuse = [&](const std::string& what) {
      throw Error(ErrorCode::scene, "the rates of the joints do not fit together: " + what, "mbd.joints",
                  "give the rate of as many joints as the machine has degrees of freedom, or fitting ones");
    };
    if (std::abs(rate[e]) > 1e-8 * fast * std::max(1.0, model_.size))
      refuse(fmt::format("{} would move at {:.3g}", equation_name(model_, e), std::abs(rate[e])));
    for (const int u : model_.held)
      if (std::abs(state_.u[u] - given[u]) > 1e-6 * fast)
        refuse(fmt::format("{} has {:.6g}, the loops ask for {:.6g}",
                           model_.coordinate_names[static_cast<std::size_t>(u)], given[u], state_.u[u]));
    Eigen::Index changed = 0;
    report_.rate_change = (state_.u - given).cwiseAbs().maxCoeff(&changed);
    report_.rate_of = model_.coordinate_names[static_cast<std::size_t>(changed)];
  }

  const scene::Scene& scene_;
  const Model& model_;
  MachineSystem& system_;
  State& state_;
  VectorXd zero_, dx_, dlambda_;
  AssemblyReport report_;
};

}  // namespace

AssemblyReport assemble(const scene::Scene& scene, const Model& model, MachineSystem& system, State& state) {
  return Assembler(scene, model, system, state).run();
}

std::string equation_name(const Model& model, int equation) {
  for (const Closure& c : model.closures)
    if (equation >= c.first && equation < c.first + c.size())
      return c.name + ": " + c.equations[static_cast<std::size_t>(equation - c.first)].what;
  return "equation " + std::to_string(equation);
}

}  // namespace tandem::mbd
