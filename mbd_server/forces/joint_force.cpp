#include "mbd_server/forces/joint_force.hpp"

#include <cmath>

namespace tandem::mbd {
namespace {

// How far the coordinate is beyond a limit, and in which direction that is.
struct Depth {
  double depth = 0, direction = 0;
};
Depth depth(const scene::Limits& limits, double q) {
  if (q > limits.upper) return {q - limits.upper, 1};
  if (q < limits.lower) return {limits.lower - q, -1};
  return {};
}

}  // namespace

JointForceValue evaluate(const JointForce& f, const Model& model, const State& state, double q, double u) {
  JointForceValue v;
  if (f.elastic.present()) {
    const ForceLaw::Value e = f.elastic.at(q - f.rest);
    v.force -= e.force, v.d_q -= e.slope;
  }
  if (f.viscous.present()) {
    const ForceLaw::Value e = f.viscous.at(u);
    v.force -= e.force, v.d_u -= e.slope;
  }
  if (f.friction) {
    const double t = std::tanh(u / f.friction->slip);
    v.force -= f.friction->force * t;
    v.d_u -= f.friction->force * (1 - t * t) / f.friction->slip;
  }
  if (f.limits) {
    // Damping that grows with the depth (Hunt, Crossley, J. Appl. Mech. 42, 1975): no jump at the first touch. A
    // stop does not pull at a body that leaves it faster than it can follow.
    const auto [d, s] = depth(*f.limits, q);
    const double k = f.limits->stiffness, c = f.limits->damping, grip = 1 + c * s * u;
    if (grip > 0) {
      v.force -= s * k * d * grip;
      v.d_q -= s * s * k * grip;
      v.d_u -= s * s * k * d * c;
    }
  }
  if (f.drive != none) v.force += model.drives[f.drive].at(state.time, state.side).value;
  if (f.input != none) v.force += state.inputs[f.input];
  return v;
}

double energy(const JointForce& f, double q) {
  double sum = f.elastic.energy(q - f.rest);
  if (f.limits) {
    const double d = depth(*f.limits, q).depth;
    sum += 0.5 * f.limits->stiffness * d * d;
  }
  return sum;
}

double dissipated_power(const JointForce& f, double q, double u) {
  double power = f.viscous.at(u).force * u;
  if (f.friction) power += f.friction->force * std::tanh(u / f.friction->slip) * u;
  if (f.limits) {
    const auto [d, s] = depth(*f.limits, q);
    const double k = f.limits->stiffness, c = f.limits->damping;
    // What a stop has stored is lost where the body leaves it behind.
    power += 1 + c * s * u > 0 ? k * d * c * u * u : -s * k * d * u;
  }
  return power;
}

bool dissipates(const JointForce& f) {
  return f.viscous.present() || f.friction || (f.limits && f.limits->damping != 0);
}

}  // namespace tandem::mbd
