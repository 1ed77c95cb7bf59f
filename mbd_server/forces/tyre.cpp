#include "mbd_server/forces/tyre.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mbd_server/forces/tyre_road.hpp"

namespace tandem::mbd {
namespace {

// Rolling speed at which three quarters of the rolling resistance act [m/s].
constexpr double resistance_speed = 0.05;
// A wheel without contact loses its deflection as if it rolled this fast besides [m/s].
constexpr double free_speed = 1;
// Below about this rolling speed the tread is damped [m/s], with half of the critical damping of a mass that
// stands on it under this gravity [m/s2].
constexpr double damped_speed = 1, standing_gravity = 9.81;
// The wheel must stand on the road: least sine of the angle between axle and normal, least share of the
// radius that is left.
constexpr double least_sine = 0.2, least_radius = 0.2;

// The wheel: centre, direction of the axle, angular velocity, and velocity of the point at the origin.
template <class T>
struct Wheel {
  Triple<T> centre, axle, w, v0;
};

template <class T>
struct Contact {
  Triple<T> p, along, across, normal;
  T radius, deflection, load;  // distance to the axle; of the vertical spring; normal force
  T slide_x, slide_y, rolling, closing;
};

template <class T>
Contact<T> contact_of(const TyreOnLink& tyre, const Wheel<T>& wheel, const RoadPlane<T>& road) {
  Contact<T> c;
  const Leg<T> leg = leg_of(wheel.centre, wheel.axle, road);
  c.normal = road.normal;
  c.along = leg.along;
  c.across = cross(c.normal, c.along);
  c.radius = leg.length;
  c.p = sum(wheel.centre, scaled(c.radius, leg.down));
  const Triple<T> v = sum(wheel.v0, cross(wheel.w, c.p));
  c.slide_x = dot(v, c.along), c.slide_y = dot(v, c.across);
  c.closing = -dot(v, c.normal) / leg.cosine;
  c.rolling = c.radius * dot(wheel.w, wheel.axle);
  c.deflection = T(tyre.radius) - c.radius;
  c.load = T(0);
  if (value_of(c.deflection) > 0) {
    const T along_leg = T(tyre.stiffness) * c.deflection + T(tyre.damping) * c.closing;
    if (value_of(along_leg) > 0) c.load = along_leg / leg.cosine;
  }
  return c;
}

Wheel<double> wheel_of(const TyreOnLink& tyre, const std::vector<LinkMotion>& links) {
  const LinkMotion& link = links[static_cast<std::size_t>(tyre.centre.link)];
  const Vector3d centre = link.point(tyre.centre.p_LP), axle = link.R_WL * tyre.axle;
  return {triple<double>(centre), triple<double>(axle), triple<double>(link.V.head<3>()),
          triple<double>(link.V.tail<3>())};
}

// How far the tread is from sliding as a whole, 1 where it does so.
template <class T>
T used(const TyreOnLink& tyre, const T& x, const T& y) {
  using std::sqrt;
  const T cx = T(tyre.slip_stiffness) * x, cy = T(tyre.cornering_stiffness) * y;
  return sqrt(cx * cx + cy * cy) / T(3 * tyre.friction);
}

template <class T>
std::array<T, 2> rates(const TyreOnLink& tyre, const Contact<T>& c, const T& x, const T& y) {
  using std::abs;
  using std::sqrt;
  const T sx = x / T(tyre.relaxation_x), sy = y / T(tyre.relaxation_y);
  const T rolling = abs(c.rolling);
  if (!(value_of(c.load) > 0)) {
    const T speed = rolling + T(free_speed);
    return {-speed * sx, -speed * sy};
  }
  T speed = rolling;
  const T psi = used(tyre, sx, sy);
  if (value_of(psi) > 1) speed = speed + sqrt(c.slide_x * c.slide_x + c.slide_y * c.slide_y) * (psi - T(1));
  return {-c.slide_x - speed * sx, -c.slide_y - speed * sy};
}

// A mass on the tread vibrates at sqrt(g c / sigma), whatever the load is [s].
double damping_time(double relaxation, double stiffness) {
  return std::sqrt(relaxation / (stiffness * standing_gravity));
}

template <class T>
struct Forces {
  T x, y, aligning, resistance;
  Triple<T> torque, force;
};

template <class T>
Forces<T> forces(const TyreOnLink& tyre, const Wheel<T>& wheel, const Contact<T>& c, const T& x, const T& y,
                 const std::array<T, 2>& rate) {
  using std::tanh;
  const T fast = c.rolling * c.rolling / T(damped_speed * damped_speed), damped = T(1) / (T(1) + fast * fast);
  const T sx = (x + damped * T(damping_time(tyre.relaxation_x, tyre.slip_stiffness)) * rate[0]) /
               T(tyre.relaxation_x),
          sy = (y + damped * T(damping_time(tyre.relaxation_y, tyre.cornering_stiffness)) * rate[1]) /
               T(tyre.relaxation_y),
          psi = used(tyre, sx, sy);
  Forces<T> f;
  T share = T(0), trail = T(0);  // of the linear force
  if (value_of(psi) < 1) {
    const T rest = T(1) - psi;
    share = T(1) - psi + psi * psi / T(3);
    trail = rest * rest * rest;
  } else {
    share = T(1) / (T(3) * psi);
  }
  f.x = c.load * T(tyre.slip_stiffness) * sx * share;
  f.y = c.load * T(tyre.cornering_stiffness) * sy * share;
  f.aligning = -c.load * T(tyre.cornering_stiffness) * sy * T(tyre.patch / 6) * trail;
  f.resistance = -T(tyre.rolling_resistance) * c.load * c.radius * tanh(c.rolling / T(resistance_speed));
  f.force = sum(sum(scaled(f.x, c.along), scaled(f.y, c.across)), scaled(c.load, c.normal));
  f.torque = sum(sum(scaled(f.aligning, c.normal), scaled(f.resistance, wheel.axle)), cross(c.p, f.force));
  return f;
}

// Displacement [0, 6), velocity [6, 12) and the two states [12, 14).
using Full = Dual<14>;

// The root of w = known + weight g(w), which is monotone.
std::array<double, 2> solved(const TyreOnLink& tyre, const Contact<double>& c, const Eigen::Vector2d& known,
                             double weight) {
  if (!(weight > 0)) return {known[0], known[1]};
  using Two = Dual<2>;
  Contact<Two> in_two;
  in_two.load = Two(c.load), in_two.rolling = Two(c.rolling);
  in_two.slide_x = Two(c.slide_x), in_two.slide_y = Two(c.slide_y);
  Eigen::Vector2d w = known;
  const auto defect = [&](const Eigen::Vector2d& at, Eigen::Matrix2d& J) {
    const auto g = rates(tyre, in_two, Two::argument(at[0], 0), Two::argument(at[1], 1));
    J << Eigen::RowVector2d(1, 0) - weight * g[0].by, Eigen::RowVector2d(0, 1) - weight * g[1].by;
    return Eigen::Vector2d(at[0] - known[0] - weight * g[0].value, at[1] - known[1] - weight * g[1].value);
  };
  Eigen::Matrix2d J;
  Eigen::Vector2d F = defect(w, J);
  const double scale = std::max(tyre.relaxation_x, tyre.relaxation_y);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d step = J.inverse() * F, begin = w;
    const double before = F.squaredNorm();
    for (double share = 1;; share /= 2) {
      w = begin - share * step;
      F = defect(w, J);
      if (F.squaredNorm() <= (1 - 1e-4 * share) * before || share < 1e-6) break;
    }
    if (step.norm() <= 1e-14 * (scale + w.norm())) break;
  }
  return {w[0], w[1]};
}

}  // namespace

TyreForce evaluate(const TyreOnLink& tyre, const State& state, const std::vector<LinkMotion>& links) {
  const LinkMotion& link = links[static_cast<std::size_t>(tyre.centre.link)];
  const Wheel<double> wheel = wheel_of(tyre, links);
  const Vector3d centre = numbers(wheel.centre), axle = numbers(wheel.axle);
  const auto expect_upright = [&](const Vector3d& normal) {
    if (!(axle.cross(normal).norm() > least_sine))
      fail_on_road(tyre, "lies on the road: its axle is within 12 degrees of the normal",
                   "keep the vehicle from overturning");
  };
  expect_upright(tyre.normal);
  const RoadPlane<double> road = plane_under(tyre, wheel.centre, wheel.axle);
  const Vector3d normal = numbers(road.normal);
  expect_upright(normal);
  if (const double height = normal.dot(centre - numbers(road.point)); !(height > least_radius * tyre.radius))
    fail_on_road(tyre,
                 fmt::format("passes through the road: its centre is {:.4g} m above it, its radius {:.4g} m",
                             height, tyre.radius),
                 "give the tyre more stiffness or damping, or keep the vehicle from overturning");
  const Contact<double> c = contact_of(tyre, wheel, road);
  const Eigen::Vector2d now = state.z.segment<2>(tyre.state),
                        known =
                            state.z_weight > 0 ? Eigen::Vector2d(state.z_known.segment<2>(tyre.state)) : now;
  const std::array<double, 2> w = solved(tyre, c, known, state.z_weight);

  // The same once more with derivatives. Displaced by psi = [turn; move] a point p goes by turn x p + move,
  // and the motion V changes by psi x V besides a change of its own.
  Wheel<Full> moved;
  const Vector6d& V = link.V;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    moved.centre[k] = Full(centre[i]), moved.axle[k] = Full(axle[i]);
    moved.w[k] = Full(V[i]), moved.v0[k] = Full(V[3 + i]);
  }
  for (int j = 0; j < 6; ++j) {
    Vector6d psi = Vector6d::Zero();
    psi[j] = 1;
    const Vector3d turn = psi.head<3>(), shift = turn.cross(centre) + psi.tail<3>(), tilt = turn.cross(axle);
    const Vector6d change = cross_motion(psi, V);
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      moved.centre[k].by[j] = shift[i], moved.axle[k].by[j] = tilt[i];
      moved.w[k].by[j] = change[i], moved.v0[k].by[j] = change[3 + i];
    }
  }
  for (int i = 0; i < 3; ++i) {
    moved.w[static_cast<std::size_t>(i)].by[6 + i] = 1;
    moved.v0[static_cast<std::size_t>(i)].by[9 + i] = 1;
  }
  const Contact<Full> d = contact_of(tyre, moved, plane_under(tyre, moved.centre, moved.axle));
  const Full x = Full::argument(w[0], 12), y = Full::argument(w[1], 13);
  const std::array<Full, 2> g = rates(tyre, d, x, y);
  const Forces<Full> f = forces(tyre, moved, d, x, y, g);

  TyreForce out;
  out.p = numbers(d.p);
  out.along = numbers(d.along), out.across = numbers(d.across), out.normal = numbers(d.normal);
  out.force << f.x.value, f.y.value, d.load.value;
  out.aligning = f.aligning.value, out.resistance = f.resistance.value;
  out.wrench << numbers(f.torque), numbers(f.force);
  out.power = out.wrench.dot(V);
  out.radius = d.radius.value;
  if (d.deflection.value > 0) {
    out.energy = 0.5 * tyre.stiffness * d.deflection.value * d.deflection.value;
    // On a curved road the deflection has another rate than the point of contact.
    out.lost = tyre.stiffness * d.deflection.value * d.radius.by.head<6>().dot(V);
  }
  out.lost -= out.power;
  out.w << w[0], w[1];
  out.w_rate << g[0].value, g[1].value;
  out.slip << w[0] / tyre.relaxation_x, w[1] / tyre.relaxation_y;

  Eigen::Matrix<double, 2, 14> by;
  by << g[0].by, g[1].by;
  const double weight = state.z_weight;
  Eigen::Matrix<double, 2, 12> of_w = Eigen::Matrix<double, 2, 12>::Zero();
  if (weight > 0)
    of_w = (Eigen::Matrix2d::Identity() - weight * by.rightCols<2>()).inverse() * weight * by.leftCols<12>();
  for (int i = 0; i < 6; ++i) {
    const Full& value =
        i < 3 ? f.torque[static_cast<std::size_t>(i)] : f.force[static_cast<std::size_t>(i - 3)];
    const Eigen::Matrix<double, 1, 12> total = value.by.leftCols<12>() + value.by.rightCols<2>() * of_w;
    out.by_displacement.row(i) = total.leftCols<6>();
    out.by_velocity.row(i) = total.rightCols<6>();
  }
  return out;
}

double load_on(const TyreOnLink& tyre, const std::vector<LinkMotion>& links) {
  const Wheel<double> wheel = wheel_of(tyre, links);
  return contact_of(tyre, wheel, plane_under(tyre, wheel.centre, wheel.axle)).load;
}

bool stands_on(const TyreOnLink& tyre, const std::vector<LinkMotion>& links, int shape) {
  const Wheel<double> wheel = wheel_of(tyre, links);
  const Contact<double> c = contact_of(tyre, wheel, plane_under(tyre, wheel.centre, wheel.axle));
  return std::ranges::any_of(points_around(tyre, wheel.axle, c.p), [&](const Triple<double>& p) {
    const auto place = tyre.road->below(numbers(begin_of_ray(tyre, wheel.centre, p)), tyre.normal);
    return place && place->surface->shape == shape;
  });
}

namespace tyre {

class Port final : public SampledPort<Port, double> {
 public:
  explicit Port(const TyreOnLink& tyre) : tyre_(tyre) {}
  double sample(const Instant& at) const { return evaluate(tyre_, at.state, at.links).lost; }
  // The power between the ends of a step is taken as linear.
  void add(double from, double to, const EnergyStep& step, EnergySums& sums) const {
    sums.add(&EnergySums::dissipated, 0.5 * step.length * (from + to), tyre_.account);
  }

 private:
  const TyreOnLink& tyre_;
};

class Kind final : public KindOfForce<Kind, TyreOnLink> {
 public:
  using KindOfForce::KindOfForce;
  bool dissipates() const override { return true; }
  void evaluate(const Instant& at) override { f_ = mbd::evaluate(data, at.state, at.links); }
  void write_states(VectorXd& z, VectorXd& rates) const override {
    z.segment<2>(data.state) = f_.w, rates.segment<2>(data.state) = f_.w_rate;
  }
  // As for contacts, the whole change of the wrench is in its derivatives.
  void add_forces(ForceReceiver& to) const override { to.wrench(data.centre, f_.wrench); }
  std::vector<int> connect(const Model&, ForceConnections& to) const override {
    return {to.between(0, data.centre.link, 6)};
  }
  void linearise(const std::vector<int>&, ForceDerivatives& to) const override {
    const LinkIndex wheel = data.centre.link;
    if (wheel == 0) return;
    to.on(wheel).leftCols<6>() -= to.weights.stiffness * f_.by_displacement;
    to.on(wheel).middleCols<6>(6) -= f_.by_velocity;
  }
  double stored_energy(const Instant& at) const override {
    return mbd::evaluate(data, at.state, at.links).energy;
  }
  std::unique_ptr<EnergyPort> energy_port() const override { return std::make_unique<Port>(data); }
  void observe(const Instant& at, ChannelValues& to) const override {
    const TyreForce f = mbd::evaluate(data, at.state, at.links);
    for (int axis = 0; axis < 3; ++axis) to.add(data.account, scene::Channel::force, f.force[axis], axis);
    to.add(data.account, scene::Channel::slip, f.slip.x());
    to.add(data.account, scene::Channel::slip_angle, std::atan(f.slip.y()));
    to.add(data.account, scene::Channel::aligning_torque, f.aligning);
    to.add(data.account, scene::Channel::loaded_radius, f.radius);
    to.add(data.account, scene::Channel::power, f.power);
    to.add(data.account, scene::Channel::stored_energy, f.energy);
    to.add(data.account, scene::Channel::loss_power, f.lost);
  }
  ForceSize size(const Instant& at) const override {
    return {.force = mbd::evaluate(data, at.state, at.links).force.norm()};
  }

 private:
  TyreForce f_;
};

}  // namespace tyre

std::shared_ptr<const ForceElement> make_force(TyreOnLink tyre) {
  return std::make_shared<tyre::Kind>(std::move(tyre), OrderOfForce{5, 5});
}

}  // namespace tandem::mbd
