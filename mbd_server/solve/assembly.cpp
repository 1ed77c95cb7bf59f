#include "mbd_server/solve/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/solve/redundancy.hpp"

namespace tandem::mbd {
namespace {

constexpr MatrixWeights mass_only{.mass = 1, .damping = 0, .stiffness = 0};
constexpr int max_iterations = 100;
// Longest correction of one iteration: 0.3 rad, or that share of the size.
constexpr double longest = 0.3;
constexpr double converged = 1e-13;
// Largest opening of a closed loop, relative to its reach.
constexpr double closed = 1e-9;

// Index of the equation with the largest residual.
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
    report_.degrees_of_freedom = report_.lasting_degrees_of_freedom = model_.freedoms;
    if (model_.equations == 0) return report_;
    decide_redundancy();
    close_loops();
    check_openings();
    count_freedoms();
    if (model_.freedoms > 0) fit_rates();
    return report_;
  }

 private:
  void factorise(const std::vector<int>* locked = nullptr) { system_.factorise(mass_only, zero_, locked); }
  double tolerance() const { return scene_.mbd->integrator.assembly_tolerance; }

  // Decides once, so that round-off and rounded data do not change the decision during the run.
  void decide_redundancy() {
    redundancy_ = find_redundancy(model_, system_, state_, tolerance());
    const Redundancy::Contradiction& odd = redundancy_.contradiction;
    if (odd.equation != none)
      throw Error(
          ErrorCode::scene,
          fmt::format(
              "lengths or directions of a loop contradict each other: {} would open by {:.3g} when the "
              "machine moves, {:.2g} of the way there, where the tolerance for geometric data is {:.2g}; "
              "held closed it would lock the machine",
              equation_name(model_, odd.equation), odd.opening, odd.share, tolerance()),
          "mbd.joints",
          fmt::format("correct the positions and axes of this loop, leave the joint out, or give "
                      "mbd.integrator.assembly_tolerance = {:.2g} if the data are no better",
                      1.5 * odd.share));
    report_.lasting_degrees_of_freedom += static_cast<int>(redundancy_.equations.size()) - model_.equations;
    system_.elimination().set_redundant(redundancy_.equations);
    system_.elimination().reserve_null_space(std::min<std::size_t>(redundancy_.equations.size() + 4, 64));
    for (const Closure& c : model_.closures)
      for (const Equation& e : c.idle) report_.redundant.push_back(c.name + ": " + e.what);
    report_.rank_deficient = !redundancy_.equations.empty();
    for (const int e : redundancy_.equations) report_.redundant.push_back(equation_name(model_, e));
  }

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
    const std::vector<Vector3d> after = positions();
    for (std::size_t b = 0; b < after.size(); ++b) {
      const double distance = (after[b] - before[b]).norm();
      if (distance > report_.distance) report_.distance = distance, report_.moved_body = static_cast<int>(b);
    }
    if (report_.distance > tolerance() * model_.size)
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

  // No motion that the other equations allow can satisfy a dependent equation. A redundant one may be
  // violated within the accuracy of the data.
  void check_openings() {
    const auto check = [&](const Closure& c, const Equation& e, bool redundant, double open) {
      const double share = std::abs(open) / (is_torque(e.kind) ? 1 : c.reach);
      if (share > (redundant ? tolerance() : closed))
        refuse_open_loop(c.name + ": " + e.what, std::abs(open));
      if (redundant && share > report_.misfit)
        report_.misfit = share, report_.misfit_of = c.name + ": " + e.what;
    };
    const VectorXd& phi = system_.constraint(Level::position);
    for (std::size_t k = 0; k < model_.closures.size(); ++k) {
      const Closure& c = model_.closures[k];
      for (int j = 0; j < c.size(); ++j) check(c, c.equations[j], redundancy_.rows[k] > 0, phi[c.first + j]);
      for (const Equation& e : c.idle) check(c, e, true, evaluate(c, e, system_.links()).position);
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

  // Bodies in the pose of the file, or as moved by a prescribed motion.
  std::vector<Vector3d> positions() {
    system_.residual(state_);
    std::vector<Vector3d> points;
    for (const BodyOnLink& b : model_.bodies) points.push_back(system_.links()[b.link].point(b.p_LB));
    return points;
  }

  void count_freedoms() {
    system_.residual(state_);
    factorise();
    report_.degrees_of_freedom += static_cast<int>(system_.dependent().size()) - model_.equations;
  }

  // The smallest change of rates, in the metric of the masses, that keeps the rates given by the scene.
  void fit_rates() {
    const VectorXd given = state_.u;
    project_rates(&model_.held);
    const VectorXd& rate = system_.constraint(Level::velocity);
    double fast = given.cwiseAbs().maxCoeff();
    for (const LinkMotion& link : system_.links()) fast = std::max(fast, std::abs(link.coordinate.rate));
    for (const Closure& c : model_.closures)
      for (int j = 0; j < c.size(); ++j) {
        const double open =
            std::abs(rate[c.first + j]) / (is_torque(c.equations[j].kind) ? 1 : std::max(1.0, c.reach));
        if (open > tolerance() * fast)
          throw Error(
              ErrorCode::scene,
              fmt::format(
                  "the rates of the joints and free bodies do not fit together: {}: {} would move at {:.3g}",
                  c.name, c.equations[j].what, std::abs(rate[c.first + j])),
              "mbd.joints",
              report_.lasting_degrees_of_freedom > 0
                  ? "give the rate of as many joints as the machine has degrees of freedom, or fitting ones"
                  : "its loops leave the machine no degree of freedom: correct their lengths and axes, or "
                    "leave a "
                    "joint out");
      }
    // Removes the residual of rates that the file has rounded.
    project_rates(nullptr);
    Eigen::Index changed = 0;
    report_.rate_change = (state_.u - given).cwiseAbs().maxCoeff(&changed);
    report_.rate_of = model_.coordinate_names[static_cast<std::size_t>(changed)];
  }

  void project_rates(const std::vector<int>* locked) {
    for (int i = 0; i < 3; ++i) {
      system_.residual(state_);
      factorise(locked);
      system_.solve(zero_, system_.constraint(Level::velocity), dx_, dlambda_);
      state_.u -= dx_;
    }
    system_.residual(state_);
  }

  const scene::Scene& scene_;
  const Model& model_;
  MachineSystem& system_;
  State& state_;
  VectorXd zero_, dx_, dlambda_;
  Redundancy redundancy_;
  AssemblyReport report_;
};

}  // namespace

AssemblyReport assemble(const scene::Scene& scene, const Model& model, MachineSystem& system, State& state) {
  return Assembler(scene, model, system, state).run();
}

void expect_closed(const Model& model, const std::vector<LinkMotion>& links, double tolerance, double time) {
  const auto check = [&](const Closure& c, const Equation& e) {
    const double open = std::abs(evaluate(c, e, links).position);
    if (open <= 10 * tolerance * (is_torque(e.kind) ? 1 : c.reach)) return;
    throw Error(ErrorCode::numerics,
                fmt::format("a loop has come apart at t = {:.9g} s: {}: {} is open by {:.3g}", time, c.name,
                            e.what, open),
                "mbd_server",
                "what the joints of this loop demand contradicts itself here: check its lengths, axes and "
                "motions, or leave "
                "a joint out");
  };
  for (const Closure& c : model.closures) {
    for (const Equation& e : c.equations) check(c, e);
    for (const Equation& e : c.idle) check(c, e);
  }
}

std::string equation_name(const Model& model, int equation) {
  for (const Closure& c : model.closures)
    if (equation >= c.first && equation < c.first + c.size())
      return c.name + ": " + c.equations[static_cast<std::size_t>(equation - c.first)].what;
  return "equation " + std::to_string(equation);
}

}  // namespace tandem::mbd
