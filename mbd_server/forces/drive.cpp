#include "mbd_server/forces/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

// A quantity with its derivatives with respect to the argument and its rate.
struct Term {
  double value = 0, d_s = 0, d_v = 0;
};
Term operator+(Term a, Term b) {
  return {a.value + b.value, a.d_s + b.d_s, a.d_v + b.d_v};
}
Term operator*(double k, Term a) {
  return {k * a.value, k * a.d_s, k * a.d_v};
}

// Torque of the shaft as felt by the argument. The curve of a motor that runs backwards is the same.
Term available(const Drive& drive, double v, double direction) {
  const ForceLaw::Value at = drive.curve.at(direction * drive.gear * v);
  return {drive.gear * at.force, 0, drive.gear * drive.gear * direction * at.slope};
}

Term limit(const Drive& drive, double v) {
  if (!drive.curve.present()) return {drive.limit, 0, 0};
  const Term most = available(drive, v, v < 0 ? -1 : 1);
  return most.value > 0 ? most : Term{};
}

ElementValue result(Term force) {
  ElementValue out;
  out.force = force.value, out.d_s = force.d_s, out.d_v = force.d_v;
  return out;
}

}  // namespace

// All of it is linear but for the limit, so that the states follow in closed form: those of the unlimited
// force first; where they ask for more than the limit, so does the force of the limited ones, since
//   (1 + weight / anti_windup) (asked - limit) = asked without the limit - limit.
ElementValue evaluate(const Drive& drive, SignalValue target, double s, double v,
                      const StatesOfElement& known, double weight) {
  if (drive.of == Drive::Of::force) {
    if (!drive.curve.present()) return result({target.value, 0, 0});
    return result(target.value * available(drive, v, target.value < 0 ? -1 : 1));
  }
  const bool of_position = drive.of == Drive::Of::position;
  const Term error{target.value - (of_position ? s : v), of_position ? -1. : 0., of_position ? 0. : -1.};
  StatesOfElement z = known, zdot = StatesOfElement::Zero();
  Term direct = drive.proportional * error;
  if (drive.has_filter()) {
    const int k = drive.has_integral() ? 1 : 0;
    const double share = weight / drive.filter / (1 + weight / drive.filter);
    const Term filtered = Term{(1 - share) * known[k], 0, 0} + share * error;
    const Term rate = 1 / drive.filter * (error + -1 * filtered);
    z[k] = filtered.value, zdot[k] = rate.value;
    direct = direct + drive.derivative * rate;
  } else if (drive.derivative != 0) {
    direct = direct + drive.derivative * Term{target.rate - v, 0, -1};
  }
  Term integral{known[0], 0, 0};
  if (drive.has_integral())
    integral = integral + weight * error;
  else
    integral = {};
  const Term asked = direct + drive.integral * integral, most = limit(drive, v);
  const bool limited = std::abs(asked.value) > most.value;
  const Term force = limited ? (asked.value > 0 ? 1 : -1) * most : asked;
  if (drive.has_integral()) {
    // The excess of the force asked for, with the states of the limited one.
    const double excess = limited ? (asked.value - force.value) / (1 + weight / drive.anti_windup) : 0;
    zdot[0] = error.value - (limited ? excess / (drive.integral * drive.anti_windup) : 0);
    z[0] = known[0] + weight * zdot[0];
  }
  ElementValue out = result(force);
  out.z = z, out.zdot = zdot;
  return out;
}

ElementValue Drive::evaluate(const LawInput& in, double s, double v) const {
  return mbd::evaluate(*this, in.signal, s, v, in.known, in.weight);
}

ElementPower Drive::power(const LawInput& in, ElementArgument x, const StatesOfElement& z) const {
  return {.work = mbd::evaluate(*this, in.signal, x.s, x.v, z, 0).force * x.v};
}

void Drive::expect_rest(const LawInput& in) const {
  const double target = in.signal.value;
  if (of != Of::rate || !has_integral() || target == 0 || std::isfinite(mbd::limit(*this, 0).value)) return;
  throw Error(ErrorCode::scene,
              fmt::format("the integral of {} grows without end in an equilibrium: its target at the "
                          "start is {:.6g} rad/s, and the machine is at rest",
                          in.name, target),
              "mbd.start",
              "let the target begin at 0, limit the torque (max_torque), leave out the integral, or "
              "leave out mbd.start = \"equilibrium\"");
}

StatesOfElement Drive::kept_at_rest(double s, const StatesOfElement& z) const {
  StatesOfElement kept = z;
  if (of == Of::rate && has_integral()) kept[0] += s;
  return kept;
}

// A filtered error is the error, so that its rate has no part in the force.
ElementValue Drive::at_rest(const LawInput& in, double s) const {
  const SignalValue target = in.signal;
  const StatesOfElement& kept = in.known;
  Drive still = *this;
  if (has_filter()) still.derivative = 0;
  const bool of_rate = of == Of::rate;
  const double error = target.value - (of_rate ? 0 : s);
  ElementValue out;
  if (!of_rate || !has_integral()) {
    out = mbd::evaluate(still, target, s, 0, kept, in.weight);
  } else {
    // z' = error - (asked - force) / (integral * anti_windup) = 0
    const double most = mbd::limit(*this, 0).value, direct = proportional * error;
    const double held = integral * (kept[0] - s);
    const bool limited = error != 0 || std::abs(held) > most;
    out.force = !limited ? held : std::copysign(most, error != 0 ? error : held);
    out.d_s = limited ? 0 : -integral;
    out.z[0] = (out.force - direct) / integral + (error != 0 ? error * anti_windup : 0);
  }
  if (has_filter()) out.z[has_integral() ? 1 : 0] = error;
  return out;
}

ElementDerivatives Drive::derivatives(const LawInput& in, double s, double v,
                                      const StatesOfElement& z) const {
  const Drive& drive = *this;
  const SignalValue target = in.signal;
  ElementDerivatives d;
  if (drive.of == Drive::Of::force) return d;
  const bool of_position = drive.of == Drive::Of::position;
  const double error = target.value - (of_position ? s : v);
  const int k = drive.has_integral() ? 1 : 0;
  // Of the force asked for: per error, per state, and per rate beside the error.
  double asked = drive.proportional * error, per_error = drive.proportional, per_rate = 0;
  Eigen::RowVector2d per_state = Eigen::RowVector2d::Zero();
  if (drive.has_filter()) {
    asked += drive.derivative * (error - z[k]) / drive.filter;
    per_error += drive.derivative / drive.filter;
    per_state[k] = -drive.derivative / drive.filter;
    (of_position ? d.g_s : d.g_v)[k] = -1 / drive.filter;
    d.g_z(k, k) = -1 / drive.filter;
  } else if (drive.derivative != 0) {
    asked += drive.derivative * (target.rate - v);
    per_rate = -drive.derivative;
  }
  if (drive.has_integral()) asked += drive.integral * z[0], per_state[0] = drive.integral;
  const Term most = mbd::limit(drive, v);
  const bool limited = std::abs(asked) > most.value;
  if (!limited) d.f_z = per_state;
  if (!drive.has_integral()) return d;
  (of_position ? d.g_s : d.g_v)[0] = -1;
  if (limited) {
    const double draw = 1 / (drive.integral * drive.anti_windup);
    (of_position ? d.g_s : d.g_v)[0] += draw * per_error;
    d.g_v[0] -= draw * (per_rate - (asked > 0 ? 1 : -1) * most.d_v);
    d.g_z.row(0) = -draw * per_state;
  } else if (!of_position) {
    d.constants = 1;
  }
  return d;
}

}  // namespace tandem::mbd
