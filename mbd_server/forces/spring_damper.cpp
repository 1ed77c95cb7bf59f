#include "mbd_server/forces/spring_damper.hpp"

#include "common/error.hpp"

namespace tandem::mbd {

SpringForce evaluate(const Spring& spring, const std::vector<LinkMotion>& links) {
  const Line line = line_between(spring.a, spring.b, links);
  if (!line.has_direction())
    throw Error(ErrorCode::numerics,
                "the ends of spring \"" + spring.name + "\" meet, so that it has no direction", "mbd_server",
                "move its points apart, or use a prismatic joint with a spring along its axis");
  const ForceLaw::Value elastic = spring.elastic.at(line.length - spring.length),
                        viscous = spring.viscous.at(line.rate());
  SpringForce f = force_along(line, {elastic.force + viscous.force, elastic.slope, viscous.slope});
  f.energy = spring.elastic.energy(line.length - spring.length);
  return f;
}

namespace spring_damper {

double dissipated(const Spring& spring, double rate) {
  return spring.viscous.at(rate).force * rate;
}

struct Sample {
  double length = 0, rate = 0, lost = 0;  // [m], [m/s], [W]
};

class Port final : public SampledPort<Port, Sample> {
 public:
  explicit Port(const Spring& spring) : spring_(spring) {}
  Sample sample(const Instant& at) const {
    const LinkMotion &a = at.links[spring_.a.link], &b = at.links[spring_.b.link];
    const Vector3d p_a = a.point(spring_.a.p_LP), p_b = b.point(spring_.b.p_LP), r = p_b - p_a;
    Sample now;
    now.length = r.norm();  // never zero, see evaluate()
    now.rate = r.dot(b.velocity(p_b) - a.velocity(p_a)) / now.length;
    now.lost = dissipated(spring_, now.rate);
    return now;
  }
  void add(const Sample& from, const Sample& to, const EnergyStep& step, EnergySums& sums) const {
    const double rate = middle_rate(to.length - from.length, from.rate, to.rate, step.length);
    sums.add(&EnergySums::dissipated, simpson(from.lost, dissipated(spring_, rate), to.lost, step.length),
             spring_.account);
  }

 private:
  const Spring& spring_;
};

class Kind final : public KindOfForce<Kind, Spring> {
 public:
  using KindOfForce::KindOfForce;
  bool dissipates() const override { return data.viscous.present(); }
  void evaluate(const Instant& at) override { f_ = mbd::evaluate(data, at.links); }
  void add_forces(ForceReceiver& to) const override {
    to.at_point(data.b, f_.p_b, f_.on_b, Vector3d::Zero());
    to.at_point(data.a, f_.p_a, -f_.on_b, Vector3d::Zero());
  }
  std::vector<int> connect(const Model&, ForceConnections& to) const override {
    return {to.between(data.a.link, data.b.link, 3)};
  }
  void linearise(const std::vector<int>& connections, ForceDerivatives& to) const override {
    to.along_line(connections[0], data.a.link, data.b.link, f_);
  }
  double stored_energy(const Instant& at) const override { return mbd::evaluate(data, at.links).energy; }
  std::unique_ptr<EnergyPort> energy_port() const override {
    if (!dissipates()) return nullptr;
    return std::make_unique<Port>(data);
  }
  void observe(const Instant& at, ChannelValues& to) const override {
    const Line line = line_between(data.a, data.b, at.links);
    const double rate = line.rate(), damper = data.viscous.at(rate).force,
                 tension = data.elastic.at(line.length - data.length).force + damper;
    to.add(data.account, scene::Channel::force, tension);
    to.add(data.account, scene::Channel::length, line.length);
    to.add(data.account, scene::Channel::velocity, rate);
    to.add(data.account, scene::Channel::power, -tension * rate);
    to.add(data.account, scene::Channel::stored_energy, data.elastic.energy(line.length - data.length));
    to.add(data.account, scene::Channel::loss_power, damper * rate);
  }
  ForceSize size(const Instant& at) const override {
    return {.force = mbd::evaluate(data, at.links).on_b.norm()};
  }

 private:
  SpringForce f_;
};

}  // namespace spring_damper

std::shared_ptr<const ForceElement> make_force(Spring spring) {
  return std::make_shared<spring_damper::Kind>(std::move(spring), OrderOfForce{1, 0});
}

}  // namespace tandem::mbd
