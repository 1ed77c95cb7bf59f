#include "mbd_server/forces/rope.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace tandem::mbd {

double tension(const RopeOnLinks& rope, double elongation, double rate) {
  return elongation > 0 ? rope.stiffness * elongation * std::max(0.0, 1 + rope.damping * rate) : 0;
}

double dissipated_power(const RopeOnLinks& rope, double elongation, double rate) {
  if (!(elongation > 0)) return 0;
  return (tension(rope, elongation, rate) - rope.stiffness * elongation) * rate;
}

RopeStretch stretch_of(const RopeOnLinks& rope, const std::vector<LinkMotion>& links) {
  RopeStretch sum{-rope.length, 0};
  if (rope.has_drum()) {
    const CoordinateMotion& drum = links[rope.drum].coordinate;
    sum = {rope.per_angle * drum.value - rope.length, rope.per_angle * drum.rate};
  }
  for (std::size_t k = 0; k + 1 < rope.points.size(); ++k) {
    const LinkMotion &a = links[rope.points[k].link], &b = links[rope.points[k + 1].link];
    const Vector3d p_a = a.point(rope.points[k].p_LP), p_b = b.point(rope.points[k + 1].p_LP), r = p_b - p_a;
    const double L = r.norm();  // never zero, see evaluate()
    sum.elongation += L;
    sum.rate += r.dot(b.velocity(p_b) - a.velocity(p_a)) / L;
  }
  return sum;
}

void evaluate(const RopeOnLinks& rope, const std::vector<LinkMotion>& links, RopeForce& f) {
  const std::size_t spans = rope.points.size() - 1;
  f.points.resize(spans + 1), f.directions.resize(spans), f.turning.resize(spans), f.lengths.resize(spans);
  const RopeStretch stretch = stretch_of(rope, links);
  for (std::size_t k = 0; k <= spans; ++k)
    f.points[k] = links[rope.points[k].link].point(rope.points[k].p_LP);
  for (std::size_t k = 0; k < spans; ++k) {
    const LinkMotion &a = links[rope.points[k].link], &b = links[rope.points[k + 1].link];
    const Vector3d r = f.points[k + 1] - f.points[k],
                   r_dot = b.velocity(f.points[k + 1]) - a.velocity(f.points[k]);
    const double L = r.norm();
    if (!(L > 1e-12))
      throw Error(ErrorCode::numerics,
                  "points " + std::to_string(k + 1) + " and " + std::to_string(k + 2) + " of rope \"" +
                      rope.name + "\" meet, so that it has no direction between them",
                  "mbd_server", "move its points apart, or hold the bodies apart by limits of a joint");
    f.lengths[k] = L;
    f.directions[k] = r / L;
    const double L_dot = f.directions[k].dot(r_dot);
    f.turning[k] = (r_dot - L_dot * f.directions[k]) / L;
  }
  f.elongation = stretch.elongation, f.rate = stretch.rate;
  f.tension = tension(rope, f.elongation, f.rate);
  f.per_elongation = f.per_rate = 0;
  if (f.is_slack()) return;
  const double damping_factor = 1 + rope.damping * f.rate;
  if (!(damping_factor > 0)) return;
  f.per_elongation = rope.stiffness * damping_factor;
  f.per_rate = rope.stiffness * f.elongation * rope.damping;
}

namespace rope {

struct Sample {
  double elongation = 0, rate = 0, lost = 0;  // [m], [m/s], [W]
};

class Port final : public SampledPort<Port, Sample> {
 public:
  explicit Port(const RopeOnLinks& rope) : rope_(rope) {}
  Sample sample(const Instant& at) const {
    const RopeStretch stretch = stretch_of(rope_, at.links);
    return {stretch.elongation, stretch.rate, dissipated_power(rope_, stretch.elongation, stretch.rate)};
  }
  void add(const Sample& from, const Sample& to, const EnergyStep& step, EnergySums& sums) const {
    const double h = step.length, rate = middle_rate(to.elongation - from.elongation, from.rate, to.rate, h);
    const double elongation = middle(from.elongation, to.elongation, from.rate, to.rate, h);
    sums.add(&EnergySums::dissipated,
             simpson(from.lost, dissipated_power(rope_, elongation, rate), to.lost, h), rope_.account);
  }

 private:
  const RopeOnLinks& rope_;
};

class Kind final : public KindOfForce<Kind, RopeOnLinks> {
 public:
  using KindOfForce::KindOfForce;
  bool dissipates() const override { return data.damping != 0; }
  void evaluate(const Instant& at) override { mbd::evaluate(data, at.links, f_); }
  void add_forces(ForceReceiver& to) const override;
  void add_to_coordinates(const Instant& at, CoordinateSums& to) const override;
  std::vector<int> connect(const Model& model, ForceConnections& to) const override;
  void linearise(const std::vector<int>& connections, ForceDerivatives& to) const override;
  double stored_energy(const Instant& at) const override {
    const double e = std::max(0.0, stretch_of(data, at.links).elongation);
    return 0.5 * data.stiffness * e * e;
  }
  std::unique_ptr<EnergyPort> energy_port() const override {
    if (!dissipates()) return nullptr;
    return std::make_unique<Port>(data);
  }
  void observe(const Instant& at, ChannelValues& to) const override {
    const RopeStretch stretch = stretch_of(data, at.links);
    const double pull = tension(data, stretch.elongation, stretch.rate);
    to.add(data.account, scene::Channel::tension, pull);
    to.add(data.account, scene::Channel::length, data.length + stretch.elongation);
    to.add(data.account, scene::Channel::slack, std::max(0.0, -stretch.elongation));
    to.add(data.account, scene::Channel::power, -pull * stretch.rate);
    to.add(data.account, scene::Channel::stored_energy, stored_energy(at));
    to.add(data.account, scene::Channel::loss_power,
           dissipated_power(data, stretch.elongation, stretch.rate));
  }
  ForceSize size(const Instant& at) const override { return {.force = tension_at(at)}; }
  double pull_on(LinkIndex coordinate, const Instant& at) const override {
    return data.drum == coordinate ? data.per_angle * tension_at(at) : 0;
  }

 private:
  double tension_at(const Instant& at) const {
    const RopeStretch stretch = stretch_of(data, at.links);
    return tension(data, stretch.elongation, stretch.rate);
  }
  void linearise_tension(int connection, ForceDerivatives& to) const;

  RopeForce f_;
};

void Kind::add_forces(ForceReceiver& to) const {
  if (f_.tension == 0) return;
  const Vector3d zero = Vector3d::Zero();
  for (std::size_t k = 0; k < f_.directions.size(); ++k) {
    const Vector3d force = f_.tension * f_.directions[k];
    PointOnBody from = data.points[k];
    // The rope pulls at the drum itself, so that its bearing has the tension in its reaction.
    if (k == 0 && data.has_drum()) from.body = data.drum_body;
    to.at_point(from, f_.points[k], force, zero);
    to.at_point(data.points[k + 1], f_.points[k + 1], -force, zero);
  }
}

void Kind::add_to_coordinates(const Instant& at, CoordinateSums& to) const {
  const int u = data.has_drum() ? at.model.links[data.drum].u : none;
  if (u == none) return;
  to.residual[u] += data.per_angle * f_.tension;
  if (!data.is_between_drum_and_ground()) return;
  to.stiffness[u] += data.per_angle * data.per_angle * f_.per_elongation;
  to.damping[u] += data.per_angle * data.per_angle * f_.per_rate;
}

// One connection for each span, and at last that of the tension.
std::vector<int> Kind::connect(const Model& model, ForceConnections& to) const {
  std::vector<LinkIndex> moving;
  for (const PointOnBody& p : data.points)
    if (p.link != 0 && std::find(moving.begin(), moving.end(), p.link) == moving.end())
      moving.push_back(p.link);
  const bool winds =
      data.has_drum() && model.links[data.drum].u != none && !data.is_between_drum_and_ground();
  if (winds && std::find(moving.begin(), moving.end(), data.drum) == moving.end())
    moving.push_back(data.drum);
  std::vector<int> connections;
  for (std::size_t k = 1; k < data.points.size(); ++k)
    connections.push_back(to.between(data.points[k - 1].link, data.points[k].link, 3));
  if (moving.size() < 2)
    connections.push_back(none);  // part of K, which the spans have made
  else
    connections.push_back(
        to.add({moving[0], moving[1], 1, true, winds, none, {moving.begin() + 2, moving.end()}}));
  return connections;
}

void Kind::linearise(const std::vector<int>& connections, ForceDerivatives& to) const {
  using Form = ForceDerivatives::Form;
  // The spans turn with their ends, at constant tension.
  for (std::size_t k = 0; k < f_.directions.size(); ++k) {
    const Vector3d n = f_.directions[k];
    const Matrix3d stiffness = -f_.tension / f_.lengths[k] * (Matrix3d::Identity() - n * n.transpose());
    Form on_a = Form::Zero(), on_b = Form::Zero();
    on_a.topRows<3>() = -stiffness * to.displacement(f_.points[k]);
    on_b.topRows<3>() = stiffness * to.displacement(f_.points[k + 1]);
    to.place(connections[k], data.points[k].link, data.points[k + 1].link,
             at_point_matrix(f_.points[k]).transpose(), at_point_matrix(f_.points[k + 1]).transpose(), on_a,
             on_b, 3);
  }
  linearise_tension(connections.back(), to);
}

// The change z of the tension acts on all links of the rope, and depends on the motion of all of them.
void Kind::linearise_tension(int connection, ForceDerivatives& to) const {
  const MatrixWeights& weights = to.weights;
  const auto side_of = [&](LinkIndex i) {
    const Connection& c = to.out.connections[connection];
    for (std::size_t s = 0; s < c.more.size(); ++s)
      if (i == c.more[s]) return static_cast<int>(s) + 2;
    return i == c.a ? 0 : 1;
  };
  if (connection != none) {
    ConnectionBlocks& block = to.out.blocks[connection];
    block.C_a.col(0).setZero(), block.C_b.col(0).setZero(), block.R_a.row(0).setZero(),
        block.R_b.row(0).setZero();
    for (ConnectionSide& side : block.more) side.C.col(0).setZero(), side.R.row(0).setZero();
    if (to.out.connections[connection].direct)
      block.on_q(side_of(data.drum)) = {
          data.per_angle,
          data.per_angle * (weights.stiffness * f_.per_elongation + weights.damping * f_.per_rate)};
  }
  Vector6d C = Vector6d::Zero();
  Eigen::Matrix<double, 1, 18> R = Eigen::Matrix<double, 1, 18>::Zero();
  const Vector3d zero = Vector3d::Zero();
  LinkIndex moving = 0;
  for (std::size_t k = 0; k < data.points.size(); ++k) {
    const LinkIndex i = data.points[k].link;
    if (i == 0) continue;
    const bool first = k == 0, last = k + 1 == data.points.size();
    // Derivatives of length and rate by the displacement of the point, and of the rate by its velocity.
    const Vector3d along = (first ? zero : f_.directions[k - 1]) - (last ? zero : f_.directions[k]),
                   turning = (first ? zero : f_.turning[k - 1]) - (last ? zero : f_.turning[k]);
    const Eigen::Matrix<double, 3, 6> L = at_point_matrix(f_.points[k]);
    const Vector6d& V = to.links[i].V;
    const Vector6d wrench = wrench_at(f_.points[k], along);
    const Eigen::Matrix<double, 1, 3> by_place =
        (f_.per_elongation * along + f_.per_rate * turning).transpose() * weights.stiffness;
    const Eigen::Matrix<double, 1, 3> by_velocity = f_.per_rate * along.transpose();
    Eigen::Matrix<double, 1, 18> row = Eigen::Matrix<double, 1, 18>::Zero();
    row.leftCols<6>() =
        by_place * L + weights.stiffness * by_velocity * (skew(V.head<3>()) * L - L * cross_matrix(V));
    row.middleCols<6>(6) = by_velocity * L;
    if (connection == none) {
      C += wrench, R += row, moving = i;
      continue;
    }
    const int side = side_of(i);
    ConnectionBlocks& block = to.out.blocks[connection];
    block.C(side).col(0) += wrench;
    block.R(side).row(0) += row;
  }
  if (connection == none && moving != 0) to.on(moving) += C * R;
}

}  // namespace rope

std::shared_ptr<const ForceElement> make_force(RopeOnLinks rope) {
  return std::make_shared<rope::Kind>(std::move(rope), OrderOfForce{3, 3});
}

}  // namespace tandem::mbd
