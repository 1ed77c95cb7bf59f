#include "mbd_server/solve/equilibrium.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

class EquilibriumSearch {
 public:
  EquilibriumSearch(const Model& model, MachineSystem& system, State& state)
      : model_(model),
        system_(system),
        state_(state),
        zero_(VectorXd::Zero(model.freedoms)),
        way_(zero_),
        dx_(zero_),
        acceleration_(zero_),
        dlambda_(VectorXd::Zero(model.equations)) {}

  EquilibriumReport run() {
    stop();
    double acceleration = accelerate();
    // The first correction is of the size `longest` where it is an acceleration over mu. The weight that
    // remains for coordinates that nothing holds is far below the stiffness of a pendulum of that size.
    const double fall = std::max(model_.gravity.norm() / model_.size, 1e-6), first = acceleration / longest,
                 least = 1e-6 * fall;
    double mu = std::max(first, least);
    EquilibriumReport report;
    for (;; ++report.iterations) {
      if (report.iterations == max_iterations) fail("was not found in 1000 iterations");
      before_ = state_;
      const double size = correct(mu);
      const double last = acceleration;
      acceleration = size <= longest ? accelerate() : HUGE_VAL;
      if (!(acceleration <= 2 * last) && size > converged) {  // too far: uphill
        state_ = before_;
        acceleration = last;
        mu *= 4;
        if (!std::isfinite(mu)) fail("was not found");
        continue;
      }
      way_ += dx_;
      if (!(system_.norm(way_) <= farthest)) fail("was not found: the machine moves away");
      // A coordinate that nothing holds drifts by round-off: its acceleration is zero, its correction is not.
      if (mu <= least && (size <= converged || acceleration <= 1e-12 * fall)) break;
      mu = std::clamp(first > 0 ? mu * acceleration / std::max(last, 1e-300) : least, least, mu);
    }
    system_.residual(state_);
    report.acceleration = acceleration;
    report.moved = system_.worst(way_);
    report.distance = way_.size() == 0 ? 0 : way_.cwiseQuotient(model_.scale).cwiseAbs().maxCoeff();
    return report;
  }

 private:
  static constexpr int max_iterations = 1000;
  static constexpr double longest = 0.2;      // correction of one iteration: rad, or sizes of the system
  static constexpr double farthest = 100;     // whole way: rad, or sizes of the system
  static constexpr double converged = 1e-12;  // correction of Newton's method: rad, or sizes of the system

  static constexpr const char* hint =
      "hold it by a spring, a joint, a stop or a motion, or leave out mbd.start = \"equilibrium\"";

  void stop() {
    state_.u.setZero();
    state_.udot.setZero();
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const int motion = model_.links[i].motion;
      if (motion == none) continue;
      const double rate = model_.motions[static_cast<std::size_t>(motion)].at(state_.time, state_.side).rate;
      if (rate != 0)
        throw Error(
            ErrorCode::scene,
            fmt::format("a joint is driven at {:.3g} rad/s or m/s at the start, and an equilibrium is "
                        "at rest",
                        rate),
            "mbd.start", "let its motion begin at rest, or leave out mbd.start = \"equilibrium\"");
    }
  }

  // Acceleration with which the machine would leave this configuration from rest, in System::norm() [1/s2];
  // the multipliers become those of that motion.
  double accelerate() {
    const VectorXd& r = system_.residual(state_);
    system_.factorise({.mass = 1, .damping = 0, .stiffness = 0}, zero_);
    system_.solve(r, system_.constraint(Level::acceleration), acceleration_, dlambda_);
    state_.lambda -= dlambda_;
    system_.shrink(state_.lambda);
    return system_.norm(acceleration_);
  }

  // The size of the correction, which is applied.
  double correct(double mu) {
    const VectorXd& r = system_.residual(state_);
    system_.factorise({.mass = mu, .damping = 0, .stiffness = 1}, zero_);
    system_.solve(r, system_.constraint(Level::position), dx_, dlambda_);
    dx_ = -dx_;
    state_.lambda -= dlambda_;
    system_.move(before_.q, dx_, state_.q);
    return system_.norm(dx_);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::scene,
                fmt::format("an equilibrium {}, largest change at {}", what, system_.worst(way_)),
                "mbd.start", hint);
  }

  const Model& model_;
  MachineSystem& system_;
  State& state_;
  State before_;
  VectorXd zero_, way_, dx_, acceleration_, dlambda_;
};

}  // namespace

EquilibriumReport find_equilibrium(const Model& model, MachineSystem& system, State& state) {
  if (!model.state_names.empty())
    throw Error(
        ErrorCode::scene,
        "an equilibrium is not searched with states of first order, here the " + model.state_names.front(),
        "mbd.start", "leave out mbd.start = \"equilibrium\", or the integral, filter or hydraulics");
  return EquilibriumSearch(model, system, state).run();
}

}  // namespace tandem::mbd
