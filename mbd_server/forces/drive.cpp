#include "mbd_server/forces/drive.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace tandem::mbd
