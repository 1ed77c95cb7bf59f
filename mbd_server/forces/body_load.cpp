#include "mbd_server/forces/body_load.hpp"

#include <cmath>

#include "mbd_server/forces/size_over_joint.hpp"

namespace tandem::mbd {
namespace body_load {

const MotionFunction& function_of(const LoadOnLink& load, const Model& model) {
  return model.drives[static_cast<std::size_t>(load.drive)];
}

double size_of(const LoadOnLink& load, const Instant& at) {
  return load.over ? size_over(*load.over, at.links[load.over->link].coordinate).value
                   : function_of(load, at.model).at(at.state.time, at.state.side).value;
}

struct Sample {
  Vector3d point = Vector3d::Zero();                  // of forces: point of application [m]
  Quaterniond orientation = Quaterniond::Identity();  // of torques: orientation of the link
  Vector3d rate = Vector3d::Zero();                   // of the point [m/s]; of the link [rad/s]
  Vector3d acceleration = Vector3d::Zero();           // rate of it
  Vector3d direction = Vector3d::Zero(), direction_rate = Vector3d::Zero();  // world axes
  double power = 0;                                                          // [W]
  CoordinateMotion over{};  // of a size over a joint coordinate
};

class Port final : public SampledPort<Port, Sample> {
 public:
  explicit Port(const LoadOnLink& load) : load_(load) {}
  Sample sample(const Instant& at) const;
  void add(const Sample& from, const Sample& to, const EnergyStep& step, EnergySums& sums) const;

 private:
  const LoadOnLink& load_;
};

Sample Port::sample(const Instant& at) const {
  const LinkMotion& link = at.links[load_.at.link];
  const Vector3d w = link.V.head<3>();
  Sample now;
  now.point = link.point(load_.at.p_LP);
  now.orientation = link.q_WL;
  now.rate = load_.torque ? w : link.velocity(now.point);
  now.acceleration = link.A.head<3>();
  if (!load_.torque) now.acceleration = at_point(link.A, now.point) + w.cross(now.rate) + at.model.gravity;
  now.direction = load_.direction;
  if (load_.follows) {
    now.direction = link.R_WL * load_.direction;
    now.direction_rate = w.cross(now.direction);
  }
  now.power = size_of(load_, at) * now.direction.dot(now.rate);
  if (load_.over) now.over = at.links[load_.over->link].coordinate;
  return now;
}

void Port::add(const Sample& from, const Sample& to, const EnergyStep& step, EnergySums& sums) const {
  const double h = step.length;
  const Vector3d moved = load_.torque
                             ? integrated_rate(from.orientation, to.orientation, from.rate, to.rate, h)
                             : Vector3d(to.point - from.point);
  const Vector3d rate =
      middle_rate(step.sudden, moved, from.rate, to.rate, from.acceleration, to.acceleration, h);
  const Vector3d direction = middle(from.direction, to.direction, from.direction_rate, to.direction_rate, h);
  const double size = load_.over ? size_over(*load_.over, between_of(from.over, to.over, h)).value
                                 : function_of(load_, step.model).at(step.begin + 0.5 * h, step.begin).value;
  const double between = size * direction.dot(rate);
  sums.add(&EnergySums::load_work, simpson(from.power, between, to.power, h), load_.account);
}

class Kind final : public KindOfForce<Kind, LoadOnLink> {
 public:
  using KindOfForce::KindOfForce;
  bool gives_energy() const override { return true; }
  const SizeOverJoint* over() const override { return data.over ? &*data.over : nullptr; }
  void evaluate(const Instant& at) override {
    const LinkMotion& link = at.links[data.at.link];
    p_ = link.point(data.at.p_LP);
    force_ = size_of(data, at) * (data.follows ? link.R_WL * data.direction : data.direction);
  }
  void add_forces(ForceReceiver& to) const override {
    const Vector3d zero = Vector3d::Zero();
    if (data.follows)
      to.following(data.at, p_, data.torque ? zero : force_, data.torque ? force_ : zero);
    else
      to.at_point(data.at, p_, data.torque ? zero : force_, data.torque ? force_ : zero);
  }
  // A connection from the link of the coordinate on which its size depends.
  std::vector<int> connect(const Model& model, ForceConnections& to) const override {
    if (!data.over || data.at.link == 0 || model.links[data.over->link].u == none) return {none};
    return {to.add({data.over->link, data.at.link, 1, true, true, none})};
  }
  // z is the change of the size, which depends on the coordinate of link a.
  void linearise(const std::vector<int>& connections, ForceDerivatives& to) const override {
    if (connections[0] == none) return;
    const LinkMotion& link = to.links[data.at.link];
    const Vector3d direction = data.follows ? link.R_WL * data.direction : data.direction,
                   zero = Vector3d::Zero();
    ConnectionBlocks& block = to.out.blocks[static_cast<std::size_t>(connections[0])];
    block.on_q_a = {0, weighted_slope(*data.over, to.links, to.weights)};
    block.on_q_b = {};
    block.C_a.setZero(), block.R_a.setZero(), block.R_b.setZero();
    block.C_b.col(0) =
        -wrench_at(link.point(data.at.p_LP), data.torque ? zero : direction, data.torque ? direction : zero);
  }
  std::unique_ptr<EnergyPort> energy_port() const override {
    if (data.at.link == 0) return nullptr;
    return std::make_unique<Port>(data);
  }
  void observe(const Instant& at, ChannelValues& to) const override {
    const LinkMotion& link = at.links[data.at.link];
    const double size = size_of(data, at);
    const Vector3d direction = data.follows ? Vector3d(link.R_WL * data.direction) : data.direction;
    const Vector3d rate = data.torque ? Vector3d(link.V.head<3>()) : link.velocity(link.point(data.at.p_LP));
    to.add(data.account, data.torque ? scene::Channel::torque : scene::Channel::force, size);
    to.add(data.account, scene::Channel::power, size * direction.dot(rate));
  }
  ForceSize size(const Instant& at) const override {
    const double size = std::abs(size_of(data, at));
    return data.torque ? ForceSize{0, size} : ForceSize{size, 0};
  }

 private:
  Vector3d p_ = Vector3d::Zero(), force_ = p_;
};

}  // namespace body_load

std::shared_ptr<const ForceElement> make_force(LoadOnLink load) {
  return std::make_shared<body_load::Kind>(std::move(load), OrderOfForce{0, 4});
}

}  // namespace tandem::mbd
