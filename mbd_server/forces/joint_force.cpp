#include "mbd_server/forces/joint_force.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/forces/size_over_joint.hpp"

namespace tandem::mbd {

Depth depth(const scene::Limits& limits, double q) {
  if (q - limits.upper > limits.lower - q) return {q - limits.upper, 1};
  return {limits.lower - q, -1};
}

double damping_number(double restitution) {
  if (restitution >= 1) return 0;
  const double e = restitution;
  double low = 0, high = 1 / e;
  for (int i = 0; i < 100; ++i) {
    const double x = (low + high) / 2;
    (std::log1p(x) - std::log1p(-e * x) < (1 + e) * x ? low : high) = x;
  }
  return low;
}

double contact_damping(const JointForce& f, double entry_rate) {
  return f.limits->restitution ? f.damping_number / std::abs(entry_rate) : f.limits->damping;
}

namespace {

// The damping grows with the depth [Hunt1975], so that the force does not jump when contact begins. A stop
// does not pull at a body that leaves it faster than the stop can follow.
void add_stop(Depth at, double k, double c, double u, JointForceValue& v) {
  const auto [d, s] = at;
  const double damping_factor = 1 + c * s * u;
  if (!(damping_factor > 0)) return;
  v.force -= s * k * d * damping_factor;
  v.d_q -= k * damping_factor;
  v.d_u -= k * d * c;
}

void add_stop(const JointForce& f, const StopContactRows& contacts, double q, double u, JointForceValue& v) {
  const scene::Limits& limits = *f.limits;
  if (contacts.cols() == 0 || f.stop == none) {
    if (const Depth at = depth(limits, q); at.depth > 0) add_stop(at, limits.stiffness, limits.damping, u, v);
    return;
  }
  // A contact begins and ends where StopContacts finds it. In between the force is smooth, so that a step
  // that is too long does not see where the contact ends.
  const auto contact = contacts.col(f.stop);
  const double entry_rate = contact[StopRow::entry_rate], settling = contact[StopRow::damping];
  if (entry_rate == 0) return;
  const Depth at = entry_rate > 0 ? Depth{q - limits.upper, 1} : Depth{limits.lower - q, -1};
  const double c = contact_damping(f, entry_rate);
  if (settling == 0) return add_stop(at, limits.stiffness, c, u, v);
  const auto [d, s] = at;
  const double force = limits.stiffness * d * (1 + c * s * u) + settling * s * u;
  if (!(d > 0) || !(force > 0)) return;
  v.force -= s * force;
  v.d_q -= limits.stiffness * (1 + c * s * u);
  v.d_u -= limits.stiffness * d * c + settling;
}

}  // namespace

double friction_share(const JointForce& f, const Model& model, const State& state) {
  if (f.share.input != none) return state.inputs[f.share.input];
  if (f.share.drive == none) return 1;
  return model.drives[static_cast<std::size_t>(f.share.drive)].at(state.time, state.side).value;
}

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
  if (f.friction && f.friction->breakaway) {
    // What holds a coordinate that sticks follows from the equations of motion. During assembly no coordinate
    // sticks or slides yet.
    const bool known = f.stiction != none && state.sliding.size() > 0;
    const double sign = known ? state.sliding[f.stiction] : (u > 0) - (u < 0);
    v.force -= f.friction->force * friction_share(f, model, state) * sign;
  } else if (f.friction) {
    const double t = std::tanh(u / f.friction->slip);
    v.force -= f.friction->force * t;
    v.d_u -= f.friction->force * (1 - t * t) / f.friction->slip;
  }
  if (f.limits) add_stop(f, state.stops, q, u, v);
  if (f.drive != none) v.force += model.drives[f.drive].at(state.time, state.side).value;
  if (f.input != none) v.force += state.inputs[f.input];
  if (f.over) {
    // A coordinate elsewhere is a connection of the linearisation.
    const SizeValue size = size_over(*f.over, coordinate_of(model, state, f.over->link));
    v.force += size.value;
    if (f.over->link == f.link) (f.over->of_rate ? v.d_u : v.d_q) += size.slope;
  }
  return v;
}

double energy(const JointForce& f, double q) {
  double sum = f.elastic.energy(q - f.rest);
  if (f.limits) {
    const double d = std::max(0.0, depth(*f.limits, q).depth);
    sum += 0.5 * f.limits->stiffness * d * d;
  }
  return sum;
}

double dissipated_power(const JointForce& f, const StopContactRows& contacts, double share, double q,
                        double u) {
  double power = f.viscous.at(u).force * u;
  if (f.friction)
    power += share * f.friction->force *
             (f.friction->breakaway ? std::abs(u) : std::tanh(u / f.friction->slip) * u);
  if (f.limits) {
    // The energy stored in a stop is lost where the body leaves the stop behind.
    if (const auto [d, s] = depth(*f.limits, q); d > 0) {
      JointForceValue stop;
      add_stop(f, contacts, q, u, stop);
      power -= (stop.force + s * f.limits->stiffness * d) * u;
    }
  }
  return power;
}

bool dissipates(const JointForce& f) {
  return f.viscous.present() || f.friction || f.limits;
}

}  // namespace tandem::mbd
