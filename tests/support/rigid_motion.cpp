#include "tests/support/rigid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/scene/tolerance.hpp"

namespace tandem::test {
namespace {

using scene::Scene;

// How each kind of quantity changes.
struct Change {
  std::function<void(Vec3d&)> point, direction;
  std::function<void(Quat&)> orientation;
  std::function<void(double&)> length;
};

// One function for each kind of force: a new kind does not compile before it is moved.
void change(scene::SpringDamper& spring, const Change& c) {
  c.point(spring.point_a), c.point(spring.point_b);
  c.length(spring.length);
}
// Between two points, without lengths of its own.
template <class Force>
requires requires(Force& f) {
  f.point_a, f.point_b;
}
void change(Force& f, const Change& c) {
  c.point(f.point_a), c.point(f.point_b);
}
void change(scene::Bushing& bushing, const Change& c) {
  c.point(bushing.position);
}
void change(scene::BodyLoad& load, const Change& c) {
  c.point(load.point);
  c.direction(load.direction);
}
void change(scene::Rope& rope, const Change& c) {
  for (scene::RopePoint& at : rope.points) c.point(at.point);
  c.length(rope.length);
}
void change(scene::Tyre& tyre, const Change& c) {
  c.point(tyre.road_point), c.direction(tyre.road_normal);
  c.length(tyre.radius), c.length(tyre.relaxation_length), c.length(tyre.patch_length);
  if (tyre.lateral_relaxation_length) c.length(*tyre.lateral_relaxation_length);
}
// These act on the coordinate of a joint.
void change(scene::RotationalSpringDamper&, const Change&) {}
void change(scene::Actuator&, const Change&) {}
void change(scene::Motor&, const Change&) {}

void change(Scene& scene, const Change& c) {
  for (scene::Body& body : scene.mbd->bodies) {
    c.point(body.pose.p_WB);
    c.orientation(body.pose.q_WB);
  }
  for (scene::Joint& joint : scene.mbd->joints) {
    c.point(joint.position);
    if (joint.child_position) c.point(*joint.child_position);
    c.direction(joint.axis);
    if (joint.type == scene::JointType::universal) c.direction(joint.axis2);
    if (joint.type == scene::JointType::screw) c.length(joint.pitch);
    if (joint.type == scene::JointType::distance) c.length(joint.length);
  }
  for (scene::Force& force : scene.mbd->forces) std::visit([&](auto& f) { change(f, c); }, force);
}

// Blocks of three rows and columns rotate with the axes: B -> R B R^T.
void turn_matrix(std::array<double, 36>& matrix, const RigidMotion& motion) {
  const auto at = [&](int i, int j) -> double& { return matrix[static_cast<std::size_t>(6 * i + j)]; };
  for (int block_row = 0; block_row < 6; block_row += 3)
    for (int block = 0; block < 6; block += 3) {
      Vec3d row[3];
      for (int i = 0; i < 3; ++i) {
        const int r = block_row + i;
        row[i] = motion.vector({at(r, block), at(r, block + 1), at(r, block + 2)});
      }
      for (int j = 0; j < 3; ++j) {
        const Vec3d column = motion.vector({row[0][j], row[1][j], row[2][j]});
        for (int i = 0; i < 3; ++i) at(block_row + i, block + j) = column[i];
      }
    }
}

void scale(scene::Motion& motion, double factor) {
  if (auto* constant = std::get_if<scene::ConstantMotion>(&motion)) {
    constant->value *= factor, constant->rate *= factor;
  } else if (auto* ramp = std::get_if<scene::RampMotion>(&motion)) {
    ramp->from *= factor, ramp->to *= factor;
  } else if (auto* harmonic = std::get_if<scene::HarmonicMotion>(&motion)) {
    harmonic->offset *= factor, harmonic->amplitude *= factor;
  } else {
    for (double& value : std::get<scene::TableMotion>(motion).values) value *= factor;
  }
}

double rounded_to(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return std::strtod(text, nullptr);
}
Vec3d rounded_to(Vec3d v, int digits) {
  return {rounded_to(v.x, digits), rounded_to(v.y, digits), rounded_to(v.z, digits)};
}

Vec3d unit(Vec3d v) {
  if (!scene::is_unit(norm(v))) throw std::invalid_argument("an axis is not of unit length to six digits");
  return normalized(v);
}
Quat unit(Quat q) {
  if (!scene::is_unit(std::sqrt(q.norm2())))
    throw std::invalid_argument("a quaternion is not of unit length to six digits");
  return q.normalized();
}

double unit_in_the_last_place(double value, int digits) {
  return value == 0 ? 0 : std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits);
}
double unit_in_the_last_place(Vec3d v, int digits) {
  return std::max({unit_in_the_last_place(v.x, digits), unit_in_the_last_place(v.y, digits),
                   unit_in_the_last_place(v.z, digits)});
}

}  // namespace

RigidMotion::RigidMotion(Quat rotation, Vec3d from_, Vec3d to_)
    : q(rotation), R(rotation.matrix()), from(from_), to(to_) {}

RigidMotion RigidMotion::quarter_turns(Quat rotation, Vec3d from, Vec3d to) {
  RigidMotion motion(rotation, from, to);
  for (Vec3d& row : motion.R.row) row = {std::round(row.x), std::round(row.y), std::round(row.z)};
  return motion;
}

Scene moved(const Scene& given, const RigidMotion& motion) {
  if (given.dem)
    throw std::invalid_argument("a scene with particles cannot be moved: their domain has the world's axes");
  Scene scene = given;
  scene.gravity = motion.vector(scene.gravity);
  change(scene, {[&](Vec3d& p) { p = motion.point(p); }, [&](Vec3d& v) { v = motion.vector(v); },
                 [&](Quat& q) { q = motion.q * q; }, [](double&) {}});
  for (scene::Body& body : scene.mbd->bodies) {
    body.twist.v_WB = motion.vector(body.twist.v_WB);
    body.twist.w_WB = motion.vector(body.twist.w_WB);
  }
  if (scene.contact)
    for (scene::Shape& shape : scene.contact->ground)
      shape.pose = {motion.point(shape.pose.p_WB), motion.q * shape.pose.q_WB};
  for (scene::Force& force : scene.mbd->forces)
    if (auto* bushing = std::get_if<scene::Bushing>(&force))
      turn_matrix(bushing->stiffness, motion), turn_matrix(bushing->damping, motion);
  return scene;
}

Scene rounded(const Scene& given, int digits) {
  Scene scene = given;
  change(scene,
         {[&](Vec3d& p) { p = rounded_to(p, digits); }, [&](Vec3d& v) { v = unit(rounded_to(v, digits)); },
          [&](Quat& q) {
            q = unit(Quat{rounded_to(q.w, digits), rounded_to(q.x, digits), rounded_to(q.y, digits),
                          rounded_to(q.z, digits)});
          },
          [&](double& length) { length = rounded_to(length, digits); }});
  return scene;
}

double last_place(const Scene& given, int digits, double size) {
  Scene scene = given;
  double largest = 0;
  const auto add = [&](double place) { largest = std::max(largest, place); };
  change(scene, {[&](Vec3d& p) { add(unit_in_the_last_place(p, digits) / size); },
                 [&](Vec3d& v) { add(unit_in_the_last_place(v, digits)); },
                 [&](Quat& q) {
                   add(unit_in_the_last_place(Vec3d{q.x, q.y, q.z}, digits));
                   add(unit_in_the_last_place(q.w, digits));
                 },
                 [&](double& length) { add(unit_in_the_last_place(length, digits) / size); }});
  return largest;
}

Scene perturbed(const Scene& given, double amount, double size, std::mt19937_64& random) {
  Scene scene = given;
  std::uniform_real_distribution<double> share(-amount, amount);
  const auto any = [&] { return Vec3d{share(random), share(random), share(random)}; };
  change(scene, {[&](Vec3d& p) { p += size * any(); }, [&](Vec3d& v) { v = normalized(v + any()); },
                 [&](Quat& q) {
                   const Vec3d d = any();
                   q = Quat{q.w + share(random), q.x + d.x, q.y + d.y, q.z + d.z}.normalized();
                 },
                 [&](double& length) { length += size * share(random); }});
  return scene;
}

Reordered reordered(const Scene& given, std::mt19937_64& random) {
  const scene::Mbd& mbd = *given.mbd;
  const auto permutation = [&](std::size_t n) {
    std::vector<std::size_t> to(n);
    std::iota(to.begin(), to.end(), 0u);
    std::shuffle(to.begin(), to.end(), random);
    return to;
  };
  Reordered r{given, permutation(mbd.bodies.size()), permutation(mbd.joints.size())};
  const auto body = [&](BodyId& id) {
    if (id != ground) id.value = static_cast<std::uint32_t>(r.body[id.value]);
  };
  const auto joint = [&](JointId& id) { id.value = static_cast<std::uint32_t>(r.joint[id.value]); };

  scene::Mbd& out = *r.scene.mbd;
  for (std::size_t b = 0; b < mbd.bodies.size(); ++b) out.bodies[r.body[b]] = mbd.bodies[b];
  for (std::size_t j = 0; j < mbd.joints.size(); ++j) {
    scene::Joint& to = out.joints[r.joint[j]] = mbd.joints[j];
    body(to.parent), body(to.child);
  }
  for (scene::Coupler& coupler : out.couplers) {
    if (coupler.terms.empty()) joint(coupler.joint_a), joint(coupler.joint_b);
    for (scene::CoupledJoint& term : coupler.terms) joint(term.joint);
  }
  for (scene::Force& force : out.forces)
    std::visit(
        [&](auto& f) {
          if constexpr (requires { f.body_a; }) body(f.body_a), body(f.body_b);
          if constexpr (requires { f.body; }) body(f.body);
          if constexpr (requires { f.joint; }) joint(f.joint);
          if constexpr (requires { f.drum; }) {
            if (f.drum) joint(*f.drum);
          }
          if constexpr (requires { f.over; }) {
            if (f.over) joint(f.over->joint);
          }
          if constexpr (requires { f.points; })
            for (scene::RopePoint& at : f.points) body(at.body);
        },
        force);
  std::shuffle(out.couplers.begin(), out.couplers.end(), random);
  std::shuffle(out.forces.begin(), out.forces.end(), random);
  return r;
}

namespace {

void scale_gains(scene::Gains& gains, double unit) {
  gains.proportional *= unit, gains.integral *= unit, gains.derivative *= unit;
}

void in_units(scene::Motor& motor, double torque) {
  scale_gains(motor.gains, torque);
  if (motor.max_torque) *motor.max_torque *= torque;
  if (motor.torque_speed)
    for (double& value : motor.torque_speed->values) value *= torque;
  motor.rotor_inertia *= torque;
  if (!motor.brake) return;
  motor.brake->torque *= torque;
  if (motor.brake->breakaway) *motor.brake->breakaway *= torque;
}

void in_units(scene::Cylinder& cylinder, double length, double mass) {
  const double force = mass * length, pressure = mass / length, volume = length * length * length;
  using Control = scene::CylinderControl;
  if (cylinder.control != Control::valve)
    scale(cylinder.target, cylinder.control == Control::stroke ? length : force);
  scale_gains(cylinder.gains, mass);
  if (cylinder.max_force) *cylinder.max_force *= force;
  cylinder.damping *= mass;
  if (cylinder.friction) cylinder.friction->force *= force, cylinder.friction->slip *= length;
  if (cylinder.limits) {
    cylinder.limits->lower *= length, cylinder.limits->upper *= length;
    cylinder.limits->stiffness *= mass, cylinder.limits->damping /= length;
  }
  if (!cylinder.hydraulics) return;
  scene::HydraulicData& oil = *cylinder.hydraulics;
  oil.bore_area *= length * length, oil.rod_area *= length * length, oil.dead_volume *= volume;
  for (double* p : {&oil.bulk_modulus, &oil.supply_pressure, &oil.tank_pressure, &oil.valve_drop,
                    &oil.laminar_drop, &oil.cavitation_pressure})
    *p *= pressure;
  for (std::optional<double>* p : {&oil.pressure_a, &oil.pressure_b})
    if (*p) **p *= pressure;
  if (oil.pump_flow) *oil.pump_flow *= volume;
  oil.valve_flow *= volume;
  oil.leakage *= volume / pressure;
}

}  // namespace

Scene in_units(const Scene& given, double length, double mass) {
  const double force = mass * length, torque = force * length;
  Scene scene = given;
  scene.gravity *= length;
  change(scene,
         {[&](Vec3d& p) { p *= length; }, [](Vec3d&) {}, [](Quat&) {}, [&](double& l) { l *= length; }});
  for (scene::Body& body : scene.mbd->bodies) {
    body.mass *= mass;
    for (double& moment : body.inertia) moment *= torque;
    body.twist.v_WB *= length;
  }
  for (scene::Joint& joint : scene.mbd->joints) {
    const bool slides = joint.type == scene::JointType::prismatic;
    if (joint.damping != 0 &&
        (joint.type == scene::JointType::cylindrical || joint.type == scene::JointType::planar))
      throw std::invalid_argument("the damping of joint " + joint.name + " has two units");
    joint.damping *= slides ? mass : torque;
    if (slides) joint.rate *= length;
    if (slides && joint.motion) scale(*joint.motion, length);
    if (joint.friction) {
      joint.friction->force *= slides ? force : torque;
      if (slides) joint.friction->slip *= length;
      if (joint.friction->breakaway) *joint.friction->breakaway *= slides ? force : torque;
    }
    if (!joint.limits) continue;
    joint.limits->stiffness *= slides ? mass : torque;
    if (slides) joint.limits->lower *= length, joint.limits->upper *= length, joint.limits->damping /= length;
  }
  const auto slides = [&](JointId joint) {
    return scene.mbd->joints[joint.value].type == scene::JointType::prismatic;
  };
  for (scene::Coupler& coupler : scene.mbd->couplers) {
    if (coupler.type == scene::CouplerType::rack_and_pinion) coupler.ratio *= length;
    if (coupler.table) {
      const double a = slides(coupler.terms[0].joint) ? length : 1,
                   b = slides(coupler.terms[1].joint) ? length : 1;
      for (double& argument : coupler.table->arguments) argument *= a;
      for (double& value : coupler.table->values) value *= b;
      if (coupler.table->period) *coupler.table->period *= a;
    } else {
      for (scene::CoupledJoint& term : coupler.terms)
        if (slides(term.joint)) term.factor /= length;
    }
  }
  const auto scale_over = [&](std::optional<scene::JointFunction>& over, double values) {
    if (!over) return;
    const double arguments = slides(over->joint) ? length : 1;
    for (double& argument : over->table.arguments) argument *= arguments;
    for (double& value : over->table.values) value *= values;
    if (over->period) *over->period *= arguments;
  };
  const auto scale_law = [](std::optional<scene::ForceTable>& table, double arguments, double values) {
    if (!table) return;
    for (double& argument : table->arguments) argument *= arguments;
    for (double& value : table->values) value *= values;
  };
  for (scene::Force& any : scene.mbd->forces) {
    if (auto* spring = std::get_if<scene::SpringDamper>(&any)) {
      spring->stiffness *= mass, spring->damping *= mass;
      scale_law(spring->table, length, force), scale_law(spring->damping_table, length, force);
    } else if (auto* rotational = std::get_if<scene::RotationalSpringDamper>(&any)) {
      rotational->stiffness *= torque, rotational->damping *= torque;
      scale_law(rotational->table, 1, torque), scale_law(rotational->damping_table, 1, torque);
    } else if (auto* bushing = std::get_if<scene::Bushing>(&any)) {
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) {
          const double unit = mass * (i < 3 ? 1 : length) * (j < 3 ? 1 : length);
          bushing->stiffness[6 * i + j] *= unit, bushing->damping[6 * i + j] *= unit;
        }
    } else if (auto* load = std::get_if<scene::BodyLoad>(&any)) {
      const double unit = load->kind == scene::BodyLoad::Kind::force ? force : torque;
      scale(load->size, unit);
      scale_over(load->over, unit);
    } else if (auto* rope = std::get_if<scene::Rope>(&any)) {
      rope->axial_stiffness *= force, rope->damping /= length;
    } else if (auto* tyre = std::get_if<scene::Tyre>(&any)) {
      tyre->stiffness *= mass, tyre->damping *= mass;
    } else if (auto* motor = std::get_if<scene::Motor>(&any)) {
      in_units(*motor, torque);
    } else if (auto* cylinder = std::get_if<scene::Cylinder>(&any)) {
      in_units(*cylinder, length, mass);
    } else if (auto* actuator = std::get_if<scene::Actuator>(&any)) {
      const double unit = slides(actuator->joint) ? force : torque;
      scale(actuator->size, unit);
      scale_over(actuator->over, unit);
    }
  }
  return scene;
}

// [Marsaglia1972]: four normal numbers, scaled to unit length together, are uniform over the rotations.
Quat random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return Quat{w, x, y, z}.normalized();
}

}  // namespace tandem::test
