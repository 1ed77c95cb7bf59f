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
double dissipated_power(const JointForce& f, double q, double u);
bool dissipates(const JointForce& f);

}  // namespace tandem::mbd
