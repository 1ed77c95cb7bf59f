// A path along x with constant acceleration, as a participant with one degree of freedom reports it.
#pragma once

#include "protocol/messages.hpp"

namespace tandem::test {

// From x [m] with v [m/s] and acceleration a [m/s2], over a window of length H [s].
inline protocol::BodyMotion straight_path(double x, double v, double a, double H) {
  protocol::BodyMotion body;
  body.begin_pose.p_WB.x = x;
  body.begin_twist.v_WB.x = v;
  body.end_pose.p_WB.x = x + v * H + a * H * H / 2;
  body.end_twist.v_WB.x = v + a * H;
  body.begin_a.x = body.end_a.x = a;
  return body;
}

}  // namespace tandem::test
