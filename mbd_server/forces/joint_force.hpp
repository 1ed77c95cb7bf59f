// Forces on one joint coordinate: spring, damper, friction, stops, actuator.
#pragma once

#include "mbd_server/model/model.hpp"
#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

struct JointForceValue {
  double force = 0;  // on the coordinate, in its direction [N m or N]
  double d_q = 0, d_u = 0;
};
JointForceValue evaluate(const JointForce& f, const Model& model, const State& state, double q, double u);
// Share of the friction that acts [-].
double friction_share(const JointForce& f, const Model& model, const State& state);
// Energy stored in spring and stops [J].
double energy(const JointForce& f, double q);
// Power lost in damper, friction and stops [W]: the power of evaluate(), without the actuator, is -d energy /
// dt less this. `contacts`: of the stops, as in State::stops; `share`: friction_share().
double dissipated_power(const JointForce& f, const StopContactRows& contacts, double share, double q,
                        double u);
bool dissipates(const JointForce& f);

// Depth of the coordinate beyond the nearer limit (negative: before it), and the direction of that limit.
struct Depth {
  double depth = 0, direction = 1;
};
Depth depth(const scene::Limits& limits, double q);

// A stop gives the force k d (1 + c d') at depth d. Where no other force acts on the inertia m, the equation
// m d' d(d')/dd = -k d (1 + c d') integrates from d' = v at the begin to -e v at the end to
//   (1 + e) x = ln((1 + x) / (1 - e x)),   x = c v,
// for any k and m. The result is x > 0 for a restitution e in (0, 1), and 0 for e = 1.
double damping_number(double restitution);
// Damping c of a stop that is reached at that rate [s/rad or s/m].
double contact_damping(const JointForce& f, double entry_rate);

}  // namespace tandem::mbd
