#include "mbd_server/forces/element_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/forces/drive.hpp"
#include "mbd_server/forces/hydraulics.hpp"
#include "mbd_server/forces/joint_force.hpp"

namespace tandem::mbd {
namespace {

SignalValue signal_value(const Signal& signal, const Model& model, const State& at) {
  if (signal.input != none) return {at.inputs[signal.input], 0};
  if (signal.drive == none) return {1, 0};
  const CoordinateMotion value = model.drives[static_cast<std::size_t>(signal.drive)].at(at.time, at.side);
  return {value.value, value.rate};
}

// Force of damping, friction and ends, and the power that they lose.
struct Passive {
  double force = 0, d_s = 0, d_v = 0, lost = 0;
};
Passive passive(const Element& e, const Model& model, const State& at, double s, double v) {
  Passive p;
  p.force -= e.damping * v, p.d_v -= e.damping, p.lost += e.damping * v * v;
  if (e.friction) {
    const double most = e.friction->force * signal_value(e.brake, model, at).value, slip = e.friction->slip;
    const double t = std::tanh(v / slip);
    p.force -= most * t, p.d_v -= most * (1 - t * t) / slip, p.lost += most * t * v;
  }
  if (!e.ends) return p;
  const auto [d, direction] = depth(*e.ends, s);
  const double k = e.ends->stiffness, grip = 1 + e.ends->damping * direction * v;
  if (!(d > 0)) return p;
  const double pushed = grip > 0 ? k * d * grip : 0;
  p.force -= direction * pushed, p.lost += (pushed - k * d) * direction * v;
  if (grip > 0) p.d_s -= k * grip, p.d_v -= k * d * e.ends->damping;
  return p;
}

}  // namespace

StatesOfElement states_of(const Element& e, const VectorXd& z) {
  StatesOfElement own = StatesOfElement::Zero();
  for (int k = 0; k < e.states; ++k) own[k] = z[e.state + k];
  return own;
}

ElementValue evaluate(const Element& e, const Model& model, const State& state, double s, double v) {
  const double weight = state.z_weight;
  const StatesOfElement guess = states_of(e, state.z),
                        known = weight > 0 ? states_of(e, state.z_known) : guess;
  const SignalValue signal = signal_value(e.signal, model, state);
  ElementValue out;
  if (state.at_rest && e.states > 0) {
    const StatesOfElement kept = states_of(e, state.z_known);
    if (const auto* drive = std::get_if<Drive>(&e.law))
      out = at_rest(*drive, signal, s, kept, weight);
    else
      out = at_rest(std::get<Hydraulics>(e.law), e.name, signal.value, s, kept, guess);
  } else if (const auto* drive = std::get_if<Drive>(&e.law)) {
    out = evaluate(*drive, signal, s, v, known, weight);
  } else {
    out = evaluate(std::get<Hydraulics>(e.law), e.name, signal.value, s, v, known, weight, guess);
  }
  const Passive p = passive(e, model, state, s, v);
  out.passive = p.force;
  out.force += p.force, out.d_s += p.d_s, out.d_v += p.d_v;
  return out;
}

StatesOfElement kept_at_rest(const Element& e, double s, const StatesOfElement& z) {
  if (const auto* oil = std::get_if<Hydraulics>(&e.law)) return kept_at_rest(*oil, s, z);
  return kept_at_rest(std::get<Drive>(e.law), s, z);
}

bool has_multiplier_at_rest(const Element& e) {
  const auto* drive = std::get_if<Drive>(&e.law);
  return drive && drive->of == Drive::Of::position && drive->has_integral();
}

ElementDerivatives derivatives(const Element& e, const Model& model, const State& state, double s, double v) {
  const StatesOfElement z = states_of(e, state.z);
  const SignalValue signal = signal_value(e.signal, model, state);
  if (const auto* drive = std::get_if<Drive>(&e.law)) return derivatives(*drive, signal, s, v, z);
  return derivatives(std::get<Hydraulics>(e.law), signal.value, s, v, z);
}

namespace {

Line line_of(const Element& e, const std::vector<LinkMotion>& links) {
  const Line line = line_between(e.a, e.b, links);
  if (!line.has_direction())
    throw Error(ErrorCode::numerics, "the ends of " + e.name + " meet, so that it has no direction",
                "mbd_server", "give it limits, or move its points apart");
  return line;
}

}  // namespace

ElementArgument argument(const Element& e, const std::vector<LinkMotion>& links) {
  if (!e.is_cylinder()) return {links[e.link].coordinate.value, links[e.link].coordinate.rate};
  const Line line = line_of(e, links);
  return {line.length - e.length, line.rate()};
}

// A force that pushes the ends apart is a negative tension.
SpringForce along_line(const Element& e, const ElementValue& value, const std::vector<LinkMotion>& links) {
  return force_along(line_of(e, links), {-value.force, -value.d_s, -value.d_v});
}

double signal_of(const Element& e, const Model& model, const State& at) {
  return signal_value(e.signal, model, at).value;
}

ElementPower power(const Element& e, const Model& model, const State& at, ElementArgument x,
                   const StatesOfElement& z) {
  const SignalValue signal = signal_value(e.signal, model, at);
  ElementPower sum;
  if (const auto* drive = std::get_if<Drive>(&e.law))
    sum.work = evaluate(*drive, signal, x.s, x.v, z, 0).force * x.v;
  else
    sum = power(std::get<Hydraulics>(e.law), signal.value, z);
  sum.lost += passive(e, model, at, x.s, x.v).lost;
  return sum;
}

double stored_energy(const Element& e, double s, const StatesOfElement& z) {
  double sum = 0;
  if (const auto* oil = std::get_if<Hydraulics>(&e.law)) sum += stored_energy(*oil, s, z);
  if (e.ends) {
    const double d = std::max(0.0, depth(*e.ends, s).depth);
    sum += 0.5 * e.ends->stiffness * d * d;
  }
  return sum;
}

ChamberFlows valve_flows(const Element& e, const Model& model, const State& at, const StatesOfElement& z) {
  const auto* oil = std::get_if<Hydraulics>(&e.law);
  return oil ? valve_flows(*oil, signal_value(e.signal, model, at).value, z) : ChamberFlows{};
}

}  // namespace tandem::mbd
