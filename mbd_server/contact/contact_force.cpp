#include "mbd_server/contact/contact_force.hpp"

#include <cmath>

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
                         double mass) {
  if (!(depth > 0)) return {};
  const double n = power_of(law), elastic = law.stiffness * std::pow(depth, n);
  double c = 0, by_depth = 0;  // of c
  if (law.damping_number > 0) {
    const double deep = share * std::sqrt(2 * normal_energy(law, depth) / mass);
    if (deep > entry_rate)
      c = law.damping_number / deep, by_depth = -c * (n + 1) / (2 * depth);
    else
      c = law.damping_number / entry_rate;
  }
  const double grip = 1 - c * gap_rate;
  if (!(grip > 0)) return {};
  return {elastic * grip, elastic * (n / depth * grip - by_depth * gap_rate), -elastic * c};
}

// Matrix of V -> V x X for a motion X: the change of a velocity X that is fixed in a link.
Matrix6d turning_matrix(const Vector6d& V) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = m.bottomRightCorner<3, 3>() = skew(V.head<3>());
  m.bottomLeftCorner<3, 3>() = skew(V.tail<3>());
  return m;
}

}  // namespace

double normal_energy(const ContactLaw& law, double depth) {
  const double n = power_of(law);
  return depth > 0 ? law.stiffness * std::pow(depth, n + 1) / (n + 1) : 0;
}

double impact_depth(const ContactLaw& law, double mass, double rate) {
  const double n = power_of(law);
  return std::pow((n + 1) * mass * rate * rate / (2 * law.stiffness), 1 / (n + 1));
}

double power(const Model& model, const ContactColumn& column, double gap, double gap_rate,
             const Vector3d& stretch, const Vector3d& sliding) {
  const ContactLaw law = model.contact.law(static_cast<int>(column[ContactRow::shape_a]),
                                           static_cast<int>(column[ContactRow::shape_b]));
  const double normal =
      normal_force(law, -gap, gap_rate, column[ContactRow::entry_rate], column[ContactRow::mass]).force;
  const Vector3d trial = -column[ContactRow::stiffness] * stretch - column[ContactRow::damping] * sliding;
  const double size = trial.norm(), most = law.friction * normal;
  return normal * gap_rate + (size > most ? most / size : 1) * trial.dot(sliding);
}

ContactFeature feature_of(const ContactColumn& column) {
  ContactFeature f;
  f.a = static_cast<int>(column[ContactRow::shape_a]), f.b = static_cast<int>(column[ContactRow::shape_b]);
  f.kind = static_cast<ContactFeature::Kind>(column[ContactRow::kind]);
  f.code = static_cast<std::int64_t>(column[ContactRow::code]);
  f.by_place = column[ContactRow::by_place] != 0;
  f.place_a = column.segment<3>(ContactRow::place_a), f.axis_a = column.segment<3>(ContactRow::axis_a);
  f.place_b = column.segment<3>(ContactRow::place_b), f.axis_b = column.segment<3>(ContactRow::axis_b);
  f.radius_a = column[ContactRow::radius_a], f.radius_b = column[ContactRow::radius_b];
  return f;
}

void set_feature(const ContactFeature& f, Eigen::Ref<ContactColumn> column) {
  column[ContactRow::shape_a] = f.a, column[ContactRow::shape_b] = f.b;
  column[ContactRow::kind] = static_cast<double>(f.kind);
  column[ContactRow::code] = static_cast<double>(f.code);
  column[ContactRow::by_place] = f.by_place;
  column.segment<3>(ContactRow::place_a) = f.place_a, column.segment<3>(ContactRow::axis_a) = f.axis_a;
  column.segment<3>(ContactRow::place_b) = f.place_b, column.segment<3>(ContactRow::axis_b) = f.axis_b;
  column[ContactRow::radius_a] = f.radius_a, column[ContactRow::radius_b] = f.radius_b;
}

ContactForce evaluate(const Model& model, const ContactColumn& column, const std::vector<LinkMotion>& links,
                      Derivatives derivatives) {
  const ContactFeature feature = feature_of(column);
  const LinkMotion &a = link_of(model, feature.a, links), &b = link_of(model, feature.b, links);
  const ContactLaw law = model.contact.law(feature.a, feature.b);
  const Touch t = touch(model, feature, links, derivatives);
  ContactForce f;
  f.p = t.p, f.n = t.n, f.gap = t.gap;
  const Vector3d &n = f.n, &p = f.p;
  const Vector6d V = b.V - a.V;
  f.velocity = at_point(V, p);
  const double gap_rate = n.dot(f.velocity);
  const NormalForce normal =
      normal_force(law, -t.gap, gap_rate, column[ContactRow::entry_rate], column[ContactRow::mass]);
  f.normal = normal.force;
  f.energy = normal_energy(law, -t.gap);

  const double k = column[ContactRow::stiffness], c = column[ContactRow::damping];
  const Vector3d x_a = a.point(column.segment<3>(ContactRow::on_a)),
                 x_b = b.point(column.segment<3>(ContactRow::on_b)), s = x_b - x_a;
  const double along_n = n.dot(s);
  f.stretch = s - along_n * n;
  f.energy += 0.5 * k * f.stretch.squaredNorm();
  if (!(f.normal > 0)) return f;
  if (derivatives == Derivatives::without) {
    f.force = f.normal * n;
    if (!(law.friction > 0)) return f;
    f.friction = -k * f.stretch - c * (f.velocity - gap_rate * n);
    const double most = law.friction * f.normal, size = f.friction.norm();
    f.slides = size > most;
    if (f.slides) f.friction = most * Vector3d(f.friction / size);
    f.force += f.friction;
    return f;
  }

  // Changes per displacement of a and of b.
  const Matrix3x6d L = at_point_matrix(p);
  const Matrix3d turn = skew(V.head<3>());
  const Matrix3x6d dv_a = L * turning_matrix(a.V) + turn * t.dp_a,
                   dv_b = -L * turning_matrix(b.V) + turn * t.dp_b;
  using Row6d = Eigen::Matrix<double, 1, 6>;
  const Row6d n_at = n.transpose() * L;
  const Row6d dN_a = normal.by_depth * n_at +
                     normal.by_rate * (f.velocity.transpose() * t.dn_a + n.transpose() * dv_a),
              dN_b = -normal.by_depth * n_at +
                     normal.by_rate * (f.velocity.transpose() * t.dn_b + n.transpose() * dv_b);
  const Row6d dN_v = normal.by_rate * n_at;
  f.force = f.normal * n;
  Matrix3x6d dF_a = n * dN_a + f.normal * t.dn_a, dF_b = n * dN_b + f.normal * t.dn_b, dF_v = n * dN_v;

  if (law.friction > 0) {
    const Matrix3d across = Matrix3d::Identity() - n * n.transpose();
    const Vector3d v_t = f.velocity - gap_rate * n;
    Vector3d trial = -k * f.stretch - c * v_t;
    const auto change = [&](const Matrix3x6d& ds, const Matrix3x6d& dv, const Matrix3x6d& dn) {
      const Matrix3x6d d_stretch = across * ds - along_n * dn - n * (s.transpose() * dn),
                       d_velocity = across * dv - gap_rate * dn - n * (f.velocity.transpose() * dn);
      return Matrix3x6d(-k * d_stretch - c * d_velocity);
    };
    Matrix3x6d dT_a = change(-at_point_matrix(x_a), dv_a, t.dn_a),
               dT_b = change(at_point_matrix(x_b), dv_b, t.dn_b), dT_v = -c * across * L;
    const double most = law.friction * f.normal, size = trial.norm();
    if (size > most) {
      f.slides = true;
      const Vector3d direction = trial / size;
      const Matrix3d rest = most / size * (Matrix3d::Identity() - direction * direction.transpose());
      const Vector3d by_normal = law.friction * direction;
      trial = most * direction;
      dT_a = by_normal * dN_a + rest * dT_a;
      dT_b = by_normal * dN_b + rest * dT_b;
      dT_v = by_normal * dN_v + rest * dT_v;
    }
    f.friction = trial;
    f.force += trial;
    dF_a += dT_a, dF_b += dT_b, dF_v += dT_v;
  }
  const Matrix3d arm = skew(p), force = skew(f.force);
  f.by_a << arm * dF_a - force * t.dp_a, dF_a;
  f.by_b << arm * dF_b - force * t.dp_b, dF_b;
  f.by_velocity << arm * dF_v, dF_v;
  return f;
}

}  // namespace tandem::mbd
