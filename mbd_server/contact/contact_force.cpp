#include "mbd_server/contact/contact_force.hpp"

#include <cmath>
#include <numbers>

namespace tandem::mbd {
namespace {

// Share of the rate v_d that counts against the rate at the begin. Several points of one body share an
// impact, and each goes deeper than the mass that it feels alone would go: by up to twice with this share.
constexpr double share = 0.5;

double power_of(const ContactLaw& law) {
  return law.hertz ? 1.5 : 1;
}

struct NormalForce {
  double force = 0, by_depth = 0, by_rate = 0;  // rate: of the gap
};

NormalForce normal_force(const ContactLaw& law, double depth, double gap_rate, double entry_rate,
                         double pressing_mass) {
  if (!(depth > 0)) return {};
  const double n = power_of(law), elastic = law.stiffness * depth * (law.hertz ? std::sqrt(depth) : 1);
  double c = 0, by_depth = 0;  // of c
  if (law.damping_number > 0) {
    const double deep = share * std::sqrt(2 * normal_energy(law, depth) / pressing_mass);
    if (deep > entry_rate)
      c = law.damping_number / deep, by_depth = -c * (n + 1) / (2 * depth);
    else
      c = law.damping_number / entry_rate;
  }
  const double damping_factor = 1 - c * gap_rate;
  if (!(damping_factor > 0)) return {};
  return {elastic * damping_factor, elastic * (n / depth * damping_factor - by_depth * gap_rate),
          -elastic * c};
}

using Row6d = Eigen::Matrix<double, 1, 6>;

// A force or moment along the surfaces, and its changes.
struct Bounded {
  Vector3d value;
  Matrix3x6d by_a, by_b, by_velocity;

  // Bounds its size by c N, where dN are the changes of N. Returns whether it was larger.
  bool bound(double c, double N, const Row6d& dN_a, const Row6d& dN_b, const Row6d& dN_v) {
    const double most = c * N, size = value.norm();
    if (!(size > most)) return false;
    const Vector3d direction = value / size, by_normal = c * direction;
    const Matrix3d rest = most / size * (Matrix3d::Identity() - direction * direction.transpose());
    value = most * direction;
    by_a = by_normal * dN_a + rest * by_a;
    by_b = by_normal * dN_b + rest * by_b;
    by_velocity = by_normal * dN_v + rest * by_velocity;
    return true;
  }
};

// Matrix of V -> V x X for a motion X: the change of a velocity X that is fixed in a link.
Matrix6d turning_matrix(const Vector6d& V) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = m.bottomRightCorner<3, 3>() = skew(V.head<3>());
  m.bottomLeftCorner<3, 3>() = skew(V.tail<3>());
  return m;
}

}  // namespace

double normal_energy(const ContactLaw& law, double depth) {
  if (!(depth > 0)) return 0;
  return law.stiffness * depth * depth * (law.hertz ? std::sqrt(depth) / 2.5 : 0.5);
}

// Stiffness dN/dd of the spring at that depth [N/m].
double normal_stiffness(const ContactLaw& law, double depth) {
  return law.hertz ? 1.5 * law.stiffness * std::sqrt(depth) : law.stiffness;
}

double depth_of(const ContactLaw& law, double force) {
  const double ratio = force / law.stiffness;
  return law.hertz ? std::cbrt(ratio * ratio) : ratio;
}

double half_period(const ContactLaw& law, double mass, double depth) {
  return std::numbers::pi * std::sqrt(mass / normal_stiffness(law, depth));
}

AlongFactors along_factors(const ContactLaw& law, const ContactPoint& point, double depth) {
  AlongFactors f;
  if (!law.hertz) return f;
  if (!(depth > 0)) return {.stiffness = 0, .damping = 0};
  f.stiffness = std::sqrt(depth), f.damping = std::sqrt(f.stiffness);
  f.stiffness_change = f.stiffness / (2 * depth), f.damping_change = f.damping / (4 * depth);
  if (const double last = point.last_depth; last < depth) {
    const double kept = std::sqrt(last / depth);
    f.stiffer = 1 - kept, f.stiffer_change = kept / (2 * depth);
  }
  return f;
}

double impact_depth(const ContactLaw& law, double mass, double rate) {
  const double n = power_of(law);
  return std::pow((n + 1) * mass * rate * rate / (2 * law.stiffness), 1 / (n + 1));
}

double rolling_radius(const ContactFeature& feature) {
  double curvature = 0;
  for (const double radius : {feature.radius_a, feature.radius_b})
    if (radius > 0) curvature += 1 / radius;
  return curvature > 0 ? 1 / curvature : 0;
}

double power(const Model& model, const ContactPoint& point, const ContactMotion& motion,
             std::optional<double> pressing) {
  const ContactLaw law = model.contact.law(point.feature.a, point.feature.b);
  const double normal =
      normal_force(law, -motion.gap, motion.gap_rate, point.entry_rate, point.pressing_mass).force;
  // Of a spring and a damper that give at most `most`.
  const auto of = [](double k, double c, const Vector3d& stretch, const Vector3d& rate, double most) {
    const Vector3d trial = -k * stretch - c * rate;
    const double size = trial.norm();
    return (size > most ? most / size : 1) * trial.dot(rate);
  };
  const double bound = pressing.value_or(normal);
  const AlongFactors along = along_factors(law, point, -motion.gap);
  return normal * motion.gap_rate +
         of(along.stiffness * point.friction.stiffness, along.damping * point.friction.damping,
            motion.stretch - along.stiffer * motion.last_stretch, motion.sliding, law.friction * bound) +
         of(along.stiffness * point.rolling.stiffness, along.damping * point.rolling.damping,
            motion.bend - along.stiffer * motion.last_bend, motion.rolling,
            law.rolling_friction * point.rolling.radius * bound);
}

ContactForce evaluate(const Model& model, const ContactPoint& point, const std::vector<LinkMotion>& links,
                      Derivatives derivatives) {
  const ContactFeature feature = point.feature;
  const LinkMotion &a = link_of(model, feature.a, links), &b = link_of(model, feature.b, links);
  const ContactLaw law = model.contact.law(feature.a, feature.b);
  const Touch t = touch(model, feature, links, derivatives);
  ContactForce f;
  if (derivatives == Derivatives::with) f.by_a.setZero(), f.by_b.setZero(), f.by_velocity.setZero();
  f.p = t.p, f.n = t.n, f.gap = t.gap;
  const Vector3d &n = f.n, &p = f.p;
  const Vector6d V = b.V - a.V;
  f.velocity = at_point(V, p);
  const double gap_rate = n.dot(f.velocity);
  const NormalForce normal = normal_force(law, -t.gap, gap_rate, point.entry_rate, point.pressing_mass);
  f.normal = normal.force;
  f.energy = normal_energy(law, -t.gap);

  const AlongFactors along = along_factors(law, point, -t.gap);
  const double k = along.stiffness * point.friction.stiffness, c = along.damping * point.friction.damping;
  const Vector3d x_a = a.point(point.friction.on_a), x_b = b.point(point.friction.on_b), s = x_b - x_a;
  const double along_n = n.dot(s);
  f.stretch = s - along_n * n;
  if (law.hertz) {
    f.stiffer = along.stiffer;
    f.last_stretch = a.R_WL * point.friction.last_stretch;
    f.last_bend = a.R_WL * point.rolling.last_bend;
  }
  f.energy += 0.5 * k * f.spring_stretch().squaredNorm();

  const double k_r = along.stiffness * point.rolling.stiffness, c_r = along.damping * point.rolling.damping;
  const bool may_roll = point.rolling.stiffness > 0;
  Vector3d d_a, d_b;  // the directions on the two links: a rotation w changes d by w x d
  const Vector3d w = V.head<3>();
  if (may_roll) {
    d_a = a.R_WL * point.rolling.on_a, d_b = b.R_WL * point.rolling.on_b;
    f.bend = n.cross(d_b - d_a);
    f.rolling = w - n.dot(w) * n;
    f.energy += 0.5 * k_r * f.spring_bend().squaredNorm();
  }
  if (!(f.normal > 0)) return f;
  const double most = law.friction * f.normal,
               most_rolling = law.rolling_friction * point.rolling.radius * f.normal;
  f.force = f.normal * n;
  if (derivatives == Derivatives::without) {
    const auto bounded = [](const Vector3d& trial, double limit, bool& beyond) {
      const double size = trial.norm();
      beyond = size > limit;
      return Vector3d(beyond ? limit / size * trial : trial);
    };
    if (law.friction > 0)
      f.friction = bounded(-k * f.spring_stretch() - c * (f.velocity - gap_rate * n), most, f.slides);
    if (may_roll) f.torque = bounded(-k_r * f.spring_bend() - c_r * f.rolling, most_rolling, f.rolls);
    f.force += f.friction;
    return f;
  }

  // Changes per displacement of a and of b.
  const Matrix3x6d L = at_point_matrix(p);
  const Matrix6d turn_a = turning_matrix(a.V), turn_b = turning_matrix(b.V);
  const Matrix3d turn = skew(w);
  const Matrix3x6d dv_a = L * turn_a + turn * t.dp_a, dv_b = -L * turn_b + turn * t.dp_b;
  const Row6d n_at = n.transpose() * L;
  const Row6d dN_a = normal.by_depth * n_at +
                     normal.by_rate * (f.velocity.transpose() * t.dn_a + n.transpose() * dv_a),
              dN_b = -normal.by_depth * n_at +
                     normal.by_rate * (f.velocity.transpose() * t.dn_b + n.transpose() * dv_b);
  const Row6d dN_v = normal.by_rate * n_at;
  Matrix3x6d dF_a = n * dN_a + f.normal * t.dn_a, dF_b = n * dN_b + f.normal * t.dn_b, dF_v = n * dN_v;
  const Matrix3d across = Matrix3d::Identity() - n * n.transpose();
  // Adds what follows from the depth, on which stiffness and damping depend.
  const auto add_change_by_depth = [&](Bounded& of, double row_k, double row_c, const Vector3d& stretch,
                                       const Vector3d& last, const Vector3d& rate) {
    if (!law.hertz) return;
    const Vector3d by_depth = -along.stiffness_change * row_k * stretch -
                              along.damping_change * row_c * rate +
                              along.stiffness * row_k * along.stiffer_change * last;
    of.by_a += by_depth * n_at;
    of.by_b -= by_depth * n_at;
    of.by_a.leftCols<3>() -= along.stiffness * row_k * along.stiffer * skew(last);  // `last` turns with a
  };

  if (law.friction > 0) {
    const Vector3d v_t = f.velocity - gap_rate * n;
    const auto change = [&](const Matrix3x6d& ds, const Matrix3x6d& dv, const Matrix3x6d& dn) {
      const Matrix3x6d d_stretch = across * ds - along_n * dn - n * (s.transpose() * dn),
                       d_velocity = across * dv - gap_rate * dn - n * (f.velocity.transpose() * dn);
      return Matrix3x6d(-k * d_stretch - c * d_velocity);
    };
    Bounded friction{-k * f.spring_stretch() - c * v_t, change(-at_point_matrix(x_a), dv_a, t.dn_a),
                     change(at_point_matrix(x_b), dv_b, t.dn_b), -c * across * L};
    add_change_by_depth(friction, point.friction.stiffness, point.friction.damping, f.spring_stretch(),
                        f.last_stretch, v_t);
    f.slides = friction.bound(law.friction, f.normal, dN_a, dN_b, dN_v);
    f.friction = friction.value;
    f.force += f.friction;
    dF_a += friction.by_a, dF_b += friction.by_b, dF_v += friction.by_velocity;
  }
  const Matrix3d arm = skew(p), force = skew(f.force);
  f.by_a << arm * dF_a - force * t.dp_a, dF_a;
  f.by_b << arm * dF_b - force * t.dp_b, dF_b;
  f.by_velocity << arm * dF_v, dF_v;

  if (may_roll) {
    const Vector3d d = d_b - d_a;
    const double spin = n.dot(w);
    const auto change = [&](const Matrix3d& dd, const Matrix3x6d& dw, const Matrix3x6d& dn) {
      Matrix3x6d d_bend = -skew(d) * dn;
      d_bend.leftCols<3>() += skew(n) * dd;
      return Matrix3x6d(-k_r * d_bend - c_r * (across * dw - spin * dn - n * (w.transpose() * dn)));
    };
    Matrix3x6d by_velocity = Matrix3x6d::Zero();
    by_velocity.leftCols<3>() = -c_r * across;
    Bounded moment{-k_r * f.spring_bend() - c_r * f.rolling, change(skew(d_a), turn_a.topRows<3>(), t.dn_a),
                   change(-skew(d_b), -turn_b.topRows<3>(), t.dn_b), by_velocity};
    add_change_by_depth(moment, point.rolling.stiffness, point.rolling.damping, f.spring_bend(), f.last_bend,
                        f.rolling);
    f.rolls = moment.bound(law.rolling_friction * point.rolling.radius, f.normal, dN_a, dN_b, dN_v);
    f.torque = moment.value;
    f.by_a.topRows<3>() += moment.by_a;
    f.by_b.topRows<3>() += moment.by_b;
    f.by_velocity.topRows<3>() += moment.by_velocity;
  }
  return f;
}

}  // namespace tandem::mbd
