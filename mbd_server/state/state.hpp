// All quantities that change during a run. A copy is a checkpoint: a run that continues from it gives the
// same bits. Assignment between states of one model does not allocate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mbd_server/spatial/spatial.hpp"
#include "mbd_server/state/contact_point.hpp"

namespace tandem::mbd {

// Data of the contact of one stop: the rows of State::stops.
struct StopRow {
  enum : Eigen::Index {
    entry_rate,  // of the coordinate as it reached the stop, beyond the upper limit positive; 0: no contact
    entry_time,  // [s]
    frequency,   // of the stop's spring with the inertia that it feels [rad/s]
    work,        // of the accelerations along the coordinate since then, plus rate^2/2 at the begin [rate^2]
    damping,     // against the rate, of a contact that has settled [N m s/rad or N s/m]
    count
  };
};

using StopContactRows = Eigen::Matrix<double, StopRow::count, Eigen::Dynamic>;

struct State {
  double time = 0;  // [s]
  // Side of a break from which functions of time are evaluated: during a step and at its end the begin of
  // the step, and `time` once the break there has been crossed. Not saved: between windows it is `time`
  // [s].
  double side = 0;
  double step = 0;          // last step size [s]; 0: none taken
  std::uint64_t steps = 0;  // taken so far
  VectorXd q;               // configuration (coordinates)
  VectorXd u;               // rates (freedoms) [rad/s or m/s]
  VectorXd udot;            // true accelerations at `time` (freedoms) [rad/s2 or m/s2]
  // Algorithmic accelerations of generalized-alpha, at time + (alpha_m - alpha_f) step (freedoms).
  VectorXd a;
  VectorXd udot_rate;  // mean rate of udot over the last step (freedoms) [rad/s3 or m/s3]
  // States of first order, z' = g(t, q, u, z), of controllers and hydraulics: the states, their rates, the
  // algorithmic rates (as `a`, at time + (alpha_m - alpha_f) step), and the mean rate of zdot over the last
  // step (first-order states).
  VectorXd z, zdot, w, zdot_rate;
  // Within a step the states depend on q and u: while z_weight > 0 they are the root of
  //   z = z_known + z_weight g(t, q, u, z),
  // for which `z` is the first guess. Not saved: between steps z_weight is 0 and the states are `z`.
  VectorXd z_known;     // (first-order states)
  double z_weight = 0;  // [s]
  // In the search for an equilibrium the states follow from the configuration instead, as those at which they
  // would rest; `z_known` is then what they keep on the way there (kept_at_rest(), forces/element_force.hpp).
  // Not saved.
  bool at_rest = false;
  VectorXd lambda;        // multipliers of the closures (equations) [N or N m]
  VectorXd inputs;        // actuator values from a controller (inputs) [N m or N]
  double next_step = 0;   // error control: the step to try next [s]; 0: no step yet
  double last_error = 0;  // error control: local error of the last step, relative to the tolerance
  // Torque about the centre of mass and force on each boundary body, world axes, linear in time: their values
  // at `load_time` [N m], [N], and their rates [N m/s], [N/s] (6 x boundary bodies).
  Eigen::Matrix<double, 6, Eigen::Dynamic> loads, load_rates;
  double load_time = 0;  // [s]
  // Contacts of the stops, maintained by StopContacts (StopRow x stops). Empty: a stop acts wherever its
  // coordinate is beyond its limit.
  StopContactRows stops;
  VectorXd sliding;  // of joints with stiction: 0 where they stick, else the sign of the rate (stictions)
  double contact_step = 0;  // longest step that contacts allow [s]; 0: no limit
  // Points of contact between bodies, maintained by BodyContacts. Empty: none touch through each other.
  std::vector<ContactPoint> contacts;
  // Longest step that they allow [s], 0: no limit (1); empty where the scene has none.
  VectorXd touch_step;
  // Of bodies that take steps of their own (ContactIslands): the last step; the longest one that contacts
  // allow, 0: no limit; and for how long the island has been at rest [s] (3 x free bodies); empty where all
  // take the same steps.
  Eigen::Matrix<double, 3, Eigen::Dynamic> island_steps;
  // Algorithmic wrench of these contacts on each boundary body, which follows it as `a` follows udot: torque
  // about its centre of mass and force, world axes [N m], [N] (6 x boundary bodies; empty likewise).
  Eigen::Matrix<double, 6, Eigen::Dynamic> contact_wrench;
  // Extrapolation: the runs with steps of `step` and of half of it, which give q, u, udot and lambda. Each
  // has its own q, u, udot, a, udot_rate, lambda, z, zdot, w, zdot_rate (packed_size); without
  // extrapolation, empty.
  VectorXd coarse, fine;

  // Load on the k-th boundary body, at `time`.
  Vector6d load(Eigen::Index k) const { return loads.col(k) + (time - load_time) * load_rates.col(k); }
};

inline Eigen::Index packed_size(const State& state) {
  return state.q.size() + 4 * state.u.size() + state.lambda.size() + 4 * state.z.size();
}

// 64-bit FNV-1a hash of the bytes of the state, in hexadecimal.
std::string hash(const State& state);

}  // namespace tandem::mbd
