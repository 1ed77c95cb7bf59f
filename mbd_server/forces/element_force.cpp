#include "mbd_server/forces/element_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
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
  const double k = e.ends->stiffness, damping_factor = 1 + e.ends->damping * direction * v;
  if (!(d > 0)) return p;
  const double pushed = damping_factor > 0 ? k * d * damping_factor : 0;
  p.force -= direction * pushed, p.lost += (pushed - k * d) * direction * v;
  if (damping_factor > 0) p.d_s -= k * damping_factor, p.d_v -= k * d * e.ends->damping;
  return p;
}

}  // namespace

StatesOfElement states_of(const Element& e, const VectorXd& z) {
  StatesOfElement own = StatesOfElement::Zero();
  for (int k = 0; k < e.states; ++k) own[k] = z[e.state + k];
  return own;
}

ElementValue evaluate(const Element& e, const Model& model, const State& state, double s, double v) {
  LawInput in = input_of(e, model, state);
  in.weight = state.z_weight;
  in.guess = states_of(e, state.z);
  const bool rests = state.at_rest && e.states > 0;
  in.known = rests || in.weight > 0 ? states_of(e, state.z_known) : in.guess;
  ElementValue out = rests ? e.law->at_rest(in, s) : e.law->evaluate(in, s, v);
  const Passive p = passive(e, model, state, s, v);
  out.passive = p.force;
  out.force += p.force, out.d_s += p.d_s, out.d_v += p.d_v;
  return out;
}

ElementDerivatives derivatives(const Element& e, const Model& model, const State& state, double s, double v) {
  return e.law->derivatives(input_of(e, model, state), s, v, states_of(e, state.z));
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

LawInput input_of(const Element& e, const Model& model, const State& at) {
  return {.name = e.name, .signal = signal_value(e.signal, model, at)};
}

ElementPower power(const Element& e, const Model& model, const State& at, ElementArgument x,
                   const StatesOfElement& z) {
  ElementPower sum = e.law->power(input_of(e, model, at), x, z);
  sum.lost += passive(e, model, at, x.s, x.v).lost;
  return sum;
}

double stored_energy(const Element& e, double s, const StatesOfElement& z) {
  double sum = e.law->stored_energy(s, z);
  if (e.ends) {
    const double d = std::max(0.0, depth(*e.ends, s).depth);
    sum += 0.5 * e.ends->stiffness * d * d;
  }
  return sum;
}

namespace element_force {

struct Sample {
  ElementArgument x{};
  StatesOfElement z = StatesOfElement::Zero();
  ElementPower power{};
};

class Port final : public SampledPort<Port, Sample> {
 public:
  explicit Port(const Element& element) : e_(element) {}
  Sample sample(const Instant& at) const {
    Sample now;
    now.x = argument(e_, at.links);
    now.z = states_of(e_, at.state.z);
    now.power = power(e_, at.model, at.state, now.x, now.z);
    return now;
  }
  // States are linear in the middle of a step: a rate that the step does not resolve would make a cubic
  // useless.
  void add(const Sample& from, const Sample& to, const EnergyStep& step, EnergySums& sums) const {
    const double h = step.length;
    const ElementArgument x{middle(from.x.s, to.x.s, from.x.v, to.x.v, h),
                            middle_rate(to.x.s - from.x.s, from.x.v, to.x.v, h)};
    const ElementPower between =
        power(e_, step.model, step.between, x, StatesOfElement(0.5 * (from.z + to.z)));
    sums.add(&EnergySums::actuator_work, simpson(from.power.work, between.work, to.power.work, h),
             e_.account);
    sums.add(&EnergySums::dissipated, simpson(from.power.lost, between.lost, to.power.lost, h), e_.account);
  }

 private:
  const Element& e_;
};

class Kind final : public KindOfForce<Kind, Element> {
 public:
  using KindOfForce::KindOfForce;
  bool dissipates() const override {
    return data.damping != 0 || data.friction || data.law->dissipates() ||
           (data.ends && data.ends->damping != 0);
  }
  bool gives_energy() const override { return true; }
  LinkIndex coordinate() const override { return data.link; }
  double rotor() const override { return data.rotor; }
  void evaluate(const Instant& at) override {
    const ElementArgument x = argument(data, at.links);
    value_ = mbd::evaluate(data, at.model, at.state, x.s, x.v);
    if (data.is_cylinder()) f_ = along_line(data, value_, at.links);
  }
  void write_states(VectorXd& z, VectorXd& rates) const override {
    for (int k = 0; k < data.states; ++k)
      z[data.state + k] = value_.z[k], rates[data.state + k] = value_.zdot[k];
  }
  void add_forces(ForceReceiver& to) const override {
    if (!data.is_cylinder()) return;
    to.at_point(data.b, f_.p_b, f_.on_b, Vector3d::Zero());
    to.at_point(data.a, f_.p_a, -f_.on_b, Vector3d::Zero());
  }
  // The rotor turns about the axis of its joint, relative to the parent; its own mass is part of the bodies.
  void add_to_coordinates(const Instant& at, CoordinateSums& to) const override {
    if (data.is_cylinder()) return;
    const int u = at.model.links[data.link].u;
    to.residual[u] += data.rotor * at.state.udot[u] - value_.force;
    to.kinetic_energy += 0.5 * data.rotor * at.state.u[u] * at.state.u[u];
    to.stiffness[u] -= value_.d_s;
    to.damping[u] -= value_.d_v;
  }
  std::vector<int> connect(const Model&, ForceConnections& to) const override {
    return {data.is_cylinder() ? to.between(data.a.link, data.b.link, 3) : none};
  }
  void linearise(const std::vector<int>& connections, ForceDerivatives& to) const override {
    if (data.is_cylinder()) to.along_line(connections[0], data.a.link, data.b.link, f_);
  }
  double stored_energy(const Instant& at) const override {
    return mbd::stored_energy(data, argument(data, at.links).s, states_of(data, at.state.z));
  }
  std::unique_ptr<EnergyPort> energy_port() const override { return std::make_unique<Port>(data); }
  void observe(const Instant& at, ChannelValues& to) const override;
  ForceSize size(const Instant& at) const override {
    const ElementArgument x = argument(data, at.links);
    const double size = std::abs(mbd::evaluate(data, at.model, at.state, x.s, x.v).force);
    return data.is_cylinder() ? ForceSize{size, 0} : ForceSize{0, size};
  }

 private:
  ElementValue value_;
  SpringForce f_;  // of a cylinder
};

// What a cylinder gives the machine is what comes in, less what it dissipates and stores.
void Kind::observe(const Instant& at, ChannelValues& to) const {
  using scene::Channel;
  const int a = data.account;
  const ElementArgument x = argument(data, at.links);
  const StatesOfElement z = states_of(data, at.state.z);
  const ElementValue value = mbd::evaluate(data, at.model, at.state, x.s, x.v);
  const LawInput in = input_of(data, at.model, at.state);
  to.add(a, Channel::loss_power, power(data, at.model, at.state, x, z).lost);
  for (const Channel channel : {Channel::target_speed, Channel::target_angle, Channel::target_stroke,
                                Channel::throttle, Channel::opening})
    to.add(a, channel, in.signal.value);
  if (!data.is_cylinder()) {
    to.add_effort(a, true, value.force - value.passive, x.v);
    to.add(a, Channel::brake_torque, value.passive);
    return;
  }
  const double stored = mbd::stored_energy(data, x.s, z);
  to.add_effort(a, false, value.force, x.v);
  if (a != none) to.add(a, Channel::energy, -to.lost(a) - (stored - to.stored_at_start));
  to.add(a, Channel::stroke, x.s);
  to.add(a, Channel::stored_energy, stored);
  data.law->observe(a, in, x, z, to);
}

}  // namespace element_force

std::shared_ptr<const ForceElement> make_force(Element element) {
  return std::make_shared<element_force::Kind>(std::move(element), OrderOfForce{4, 1});
}

}  // namespace tandem::mbd
