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
// Stored in spring and stops [J].
double energy(const JointForce& f, double q);
// Lost in damper, friction and stops [W]: evaluate(), without the actuator, does -d energy / dt less this.
// `contacts`: of the stops, as in State::stops.
double dissipated_power(const JointForce& f, const StopContactRows& contacts, double q, double u);
bool dissipates(const JointForce& f);

// How far the coordinate is beyond the nearer limit (negative: before it), and in which direction that limit
// is.
struct Depth {
  double depth = 0, direction = 1;
};
Depth depth(const scene::Limits& limits, double q);

// A stop gives the force k d (1 + c d') at depth d. With nothing else than it acting on an inertia, m d'
// d(d')/dd = -k d (1 + c d') from d' = v at the begin to -e v at the end integrates to
//   (1 + e) x = ln((1 + x) / (1 - e x)),   x = c v,
// whatever k and m are. The result is x > 0 for a restitution e in (0, 1), 0 for 1.
double damping_number(double restitution);
// c of a stop that is entered at that rate [s/rad or s/m].
double contact_damping(const JointForce& f, double entry_rate);

}  // namespace tandem::mbd
