#include "mbd_server/solve/machine_system.hpp"

#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "mbd_server/forces/size_over_joint.hpp"

namespace tandem::mbd {

bool MachineSystem::rate_jump(const State& before, const State& after, VectorXd& r, VectorXd& c) {
  if (before.side == after.side) return false;
  bool jumps = false;
  for (Eigen::Index i = 0; i < driven_.size(); ++i) {
    const MotionFunction& motion = model_.motions[static_cast<std::size_t>(i)];
    const double u0 = motion.at(before.time, before.side).rate, u1 = motion.at(after.time, after.side).rate;
    driven_[i] = u1 - u0;
    jumps |= std::abs(driven_[i]) > 1e-10 * (std::abs(u0) + std::abs(u1));
  }
  if (!jumps) return false;
  r = -dynamics_.residual(after);
  c = -dynamics_.constraint(Level::acceleration);
  r += dynamics_.residual(after, &driven_);
  c += dynamics_.constraint(Level::acceleration);
  return true;
}

// A state without `sliding`, as during assembly, has no coordinate that sticks.
void MachineSystem::find_stuck(const State& state) {
  stuck_.clear();
  for (Eigen::Index i = 0; i < state.sliding.size(); ++i)
    if (state.sliding[i] == 0)
      stuck_.push_back(model_.links[model_.joint_forces[model_.stictions[i]].link].u);
}

void MachineSystem::move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const {
  for (const Link& link : model_.links)
    if (link.u != none) mbd::move(link.kind, &q0[link.q], &x[link.u], &q1[link.q]);
}

void MachineSystem::difference(const VectorXd& q0, const VectorXd& q1, VectorXd& x) const {
  for (const Link& link : model_.links)
    if (link.u != none) mbd::difference(link.kind, &q0[link.q], &q1[link.q], &x[link.u]);
}

bool MachineSystem::increment_rate(const VectorXd& x, const VectorXd& u, VectorXd& rate) const {
  rate = u;
  for (const int k : articulated_.spherical()) {
    const Vector3d turn = x.segment<3>(k);
    if (!(turn.squaredNorm() < std::numbers::pi * std::numbers::pi)) return false;
    rate.segment<3>(k) = inverse_tangent_operator(turn) * u.segment<3>(k);
  }
  return true;
}

void MachineSystem::factorise(const MatrixWeights& weights, const VectorXd& x,
                              const std::vector<int>* locked) {
  expect_regular(elimination_.factorise(dynamics_, weights, x, locked));
}

const VectorXd& MachineSystem::acceleration(const State& state) {
  const VectorXd& forces = dynamics_.local_forces(state);
  expect_regular(articulated_.solve(dynamics_, state.udot, forces));
  return articulated_.acceleration();
}

// `singular`: coordinate whose pivot vanishes, or -1.
void MachineSystem::expect_regular(Eigen::Index singular) const {
  if (singular >= 0)
    throw Error(ErrorCode::numerics,
                "the equations of motion are singular at " +
                    model_.coordinate_names[static_cast<std::size_t>(singular)],
                "mbd_server",
                "nothing resists an acceleration there: give the body mass and inertia, and check for NaN in "
                "its loads");
}

double MachineSystem::norm(const VectorXd& dx) const {
  return dx.size() == 0
             ? 0
             : std::sqrt(dx.cwiseQuotient(model_.scale).squaredNorm() / static_cast<double>(dx.size()));
}

std::string MachineSystem::obstacle() const {
  constexpr double near = 0.1;  // [rad] from a singular position
  const int k = elimination_.tightest_closure();
  if (k == none || elimination_.smallest_sine() > near) return {};
  return "the loop that " + model_.closures[static_cast<std::size_t>(k)].name +
         " closes is stretched or folded there: a motion may ask more of it than it can reach; or, where "
         "lengths "
         "should be equal, they have too few digits: give positions and axes of its joints with more";
}

double MachineSystem::curvature(const State& state) const {
  const auto u = state.u.cwiseQuotient(model_.scale), udot = state.udot.cwiseQuotient(model_.scale);
  const double uu = u.squaredNorm();
  return uu > 0 ? (udot - u * (u.dot(udot) / uu)).norm() / uu : 0;
}

double MachineSystem::unseen(const State& begin, const State& end) const {
  double most = 0;
  const auto look = [&](const SizeOverJoint* over) {
    if (!over) return;
    const CoordinateMotion x0 = coordinate_of(model_, begin, over->link),
                           x1 = coordinate_of(model_, end, over->link);
    most = std::max(
        most, over->of_rate ? over->curve.unseen(x0.rate, x1.rate) : over->curve.unseen(x0.value, x1.value));
  };
  for (const auto& force : model_.forces) look(force->over());
  for (const JointForce& force : model_.joint_forces) look(force.over ? &*force.over : nullptr);
  return most;
}

double MachineSystem::state_norm(const VectorXd& dz) const {
  return dz.size() == 0 ? 0 : dz.cwiseQuotient(model_.state_scale).cwiseAbs().maxCoeff();
}

std::string MachineSystem::worst_state(const VectorXd& dz) const {
  if (dz.size() == 0) return "no state";
  Eigen::Index i = 0;
  dz.cwiseQuotient(model_.state_scale).cwiseAbs().maxCoeff(&i);
  return model_.state_names[static_cast<std::size_t>(i)];
}

std::string MachineSystem::worst(const VectorXd& dx) const {
  if (dx.size() == 0) return "no coordinate";
  Eigen::Index i = 0;
  // A coordinate that is not a number counts as the largest.
  dx.cwiseQuotient(model_.scale)
      .cwiseAbs()
      .unaryExpr([](double v) { return std::isnan(v) ? HUGE_VAL : v; })
      .maxCoeff(&i);
  return model_.coordinate_names[i];
}

}  // namespace tandem::mbd
