#include "mbd_server/forces/bushing.hpp"

#include <numbers>

#include "common/error.hpp"

namespace tandem::mbd {

BushingForce evaluate(const BushingOnLinks& bushing, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = links[bushing.a.link], &b = links[bushing.b.link];
  BushingForce f;
  f.p = b.point(bushing.b.p_LP);
  const Matrix3d R = a.R_WL.transpose();
  const Vector3d turn = to_eigen(rotation_vector(to_quat(a.q_WL.conjugate() * b.q_WL)));
  if (turn.norm() > 0.99 * std::numbers::pi)
    throw Error(ErrorCode::numerics, "bushing \"" + bushing.name + "\" is turned by half a turn",
                "mbd_server", "a bushing is for small rotations: use a joint");
  Vector6d displacement, rate;
  displacement << R * (f.p - a.point(bushing.a.p_LP)), turn;
  rate << R * at_point(b.V - a.V, f.p), R * (b.V - a.V).head<3>();
  const Vector6d local = -(bushing.stiffness * displacement + bushing.damping * rate);
  f.on_b << a.R_WL * local.head<3>(), a.R_WL * local.tail<3>();
  f.energy = 0.5 * displacement.dot(bushing.stiffness * displacement);

  // Transforms to the axes of a; a rotation w of b relative to a changes the rotation vector by T^-T w.
  Matrix6d in_a = Matrix6d::Zero(), moved = Matrix6d::Zero(), out = Matrix6d::Zero();
  in_a.topRightCorner<3, 3>() = in_a.bottomLeftCorner<3, 3>() = R;
  moved.topRightCorner<3, 3>() = R;
  moved.bottomLeftCorner<3, 3>() = tangent_operator(turn).transpose().inverse() * R;
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = a.R_WL;
  f.d_displacement = -out * bushing.stiffness * moved;
  f.d_velocity = -out * bushing.damping * in_a;
  return f;
}

namespace bushing {

double dissipated(const BushingOnLinks& bushing, const Vector6d& rate) {
  return rate.dot(bushing.damping * rate);
}

struct Sample {
  Vector3d displacement = Vector3d::Zero();           // axes of a [m]
  Quaterniond orientation = Quaterniond::Identity();  // of b relative to a
  Vector6d rate = Vector6d::Zero();                   // axes of a: velocity, angular velocity
  double lost = 0;                                    // [W]
};

class Port final : public SampledPort<Port, Sample> {
 public:
  explicit Port(const BushingOnLinks& bushing) : bushing_(bushing) {}
  Sample sample(const Instant& at) const {
    const LinkMotion &a = at.links[bushing_.a.link], &b = at.links[bushing_.b.link];
    const Vector3d p = b.point(bushing_.b.p_LP);
    const Matrix3d R = a.R_WL.transpose();
    const Vector6d V = b.V - a.V;
    Sample now;
    now.displacement = R * (p - a.point(bushing_.a.p_LP));
    now.orientation = a.q_WL.conjugate() * b.q_WL;
    now.rate << R * at_point(V, p), R * V.head<3>();
    now.lost = dissipated(bushing_, now.rate);
    return now;
  }
  void add(const Sample& from, const Sample& to, const EnergyStep& step, EnergySums& sums) const {
    const double h = step.length;
    Vector6d moved;
    moved << to.displacement - from.displacement,
        integrated_rate(from.orientation, to.orientation, from.rate.tail<3>(), to.rate.tail<3>(), h);
    const Vector6d rate = middle_rate(moved, from.rate, to.rate, h);
    sums.add(&EnergySums::dissipated, simpson(from.lost, dissipated(bushing_, rate), to.lost, h),
             bushing_.account);
  }

 private:
  const BushingOnLinks& bushing_;
};

class Kind final : public KindOfForce<Kind, BushingOnLinks> {
 public:
  using KindOfForce::KindOfForce;
  bool dissipates() const override { return !data.damping.isZero(0); }
  void evaluate(const Instant& at) override { f_ = mbd::evaluate(data, at.links); }
  void add_forces(ForceReceiver& to) const override {
    const Vector6d wrench = wrench_at(f_.p, f_.on_b.head<3>(), f_.on_b.tail<3>());
    to.wrench(data.b, wrench);
    to.wrench(data.a, -wrench);
  }
  std::vector<int> connect(const Model&, ForceConnections& to) const override {
    return {to.between(data.a.link, data.b.link, 6)};
  }
  void linearise(const std::vector<int>& connections, ForceDerivatives& to) const override;
  double stored_energy(const Instant& at) const override { return mbd::evaluate(data, at.links).energy; }
  std::unique_ptr<EnergyPort> energy_port() const override {
    if (!dissipates()) return nullptr;
    return std::make_unique<Port>(data);
  }
  void observe(const Instant& at, ChannelValues& to) const override;
  ForceSize size(const Instant& at) const override {
    const BushingForce f = mbd::evaluate(data, at.links);
    return {f.on_b.head<3>().norm(), f.on_b.tail<3>().norm()};
  }

 private:
  BushingForce f_;
};

void Kind::linearise(const std::vector<int>& connections, ForceDerivatives& to) const {
  using Form = ForceDerivatives::Form;
  const LinkIndex a = data.a.link, b = data.b.link;
  const double stiffness = to.weights.stiffness;
  // Displacement and rotation, velocity and angular velocity of b relative to a, as an observer on a measures
  // them.
  const Eigen::Matrix<double, 3, 6> L = at_point_matrix(f_.p);
  Matrix6d relative;
  relative.topRows<3>().setZero();
  relative.topLeftCorner<3, 3>().setIdentity();
  relative.bottomRows<3>() = L;
  // dv = at_point(psi x V_b + eta, p) + w_rel x dp, less the rotation with a.
  const Vector3d w = (to.links[b].V - to.links[a].V).head<3>();
  Matrix6d turning = -relative * cross_matrix(to.links[b].V);
  turning.bottomRows<3>() += skew(w) * L;
  Form change = Form::Zero();
  change.leftCols<6>() = stiffness * (f_.d_displacement * relative + f_.d_velocity * turning);
  change.middleCols<6>(6) = f_.d_velocity * relative;
  // on_b rotates with a.
  Form turn_with_a = Form::Zero();
  turn_with_a.topLeftCorner<3, 3>() = -stiffness * skew(f_.on_b.head<3>());
  turn_with_a.block<3, 3>(3, 0) = -stiffness * skew(f_.on_b.tail<3>());
  Matrix6d wrench;  // maps force and torque at p to a spatial force
  wrench << skew(f_.p), Matrix3d::Identity(), Matrix3d::Identity(), Matrix3d::Zero();
  Form change_b = wrench * change;
  change_b.topLeftCorner<3, 6>() -= stiffness * skew(f_.on_b.head<3>()) * L;  // p moves with b
  to.place(connections[0], a, b, Matrix6d::Identity(), Matrix6d::Identity(),
           Form(wrench * (turn_with_a - change)), change_b, 6);
}

void Kind::observe(const Instant& at, ChannelValues& to) const {
  const BushingForce f = mbd::evaluate(data, at.links);
  const LinkMotion &a = at.links[data.a.link], &b = at.links[data.b.link];
  const Vector6d V = b.V - a.V;
  const Vector3d v = at_point(V, f.p), w = V.head<3>(), force = f.on_b.head<3>(), torque = f.on_b.tail<3>();
  const Vector3d force_a = a.R_WL.transpose() * force, torque_a = a.R_WL.transpose() * torque;
  for (int axis = 0; axis < 3; ++axis) {
    to.add(data.account, scene::Channel::force, force_a[axis], axis);
    to.add(data.account, scene::Channel::torque, torque_a[axis], axis);
  }
  Vector6d rate;
  rate << a.R_WL.transpose() * v, a.R_WL.transpose() * w;
  to.add(data.account, scene::Channel::power, force.dot(v) + torque.dot(w));
  to.add(data.account, scene::Channel::stored_energy, f.energy);
  to.add(data.account, scene::Channel::loss_power, rate.dot(data.damping * rate));
}

}  // namespace bushing

std::shared_ptr<const ForceElement> make_force(BushingOnLinks bushing) {
  return std::make_shared<bushing::Kind>(std::move(bushing), OrderOfForce{2, 2});
}

}  // namespace tandem::mbd
