// launch/scenes/washing_machine.json against a model derived here by hand: the tub as a rigid body with six
// freedoms, the drum with the laundry as a rigid rotor on its shaft (Newton and Euler, projected by
// Jacobians). The nonlinear model is integrated by Runge-Kutta; linearised at a constant speed it is the 6 x
// 6 model
//   M x'' + (C + G) x' + K x = Re(F e^(i Omega t)),
// which gives the amplitudes of the steady vibration over the speed, and with the drum the natural modes.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <functional>
#include <numbers>

#include "common/scene/motion_function.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "mbd_server/solve/modes.hpp"
#include "tests/verification/mbd/comparison.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/recorded_run.hpp"

namespace tandem::mbd {
namespace washing_machine_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr double pi = std::numbers::pi;
constexpr double rpm = pi / 30;

enum Bodies : std::size_t { cabinet, tub, drum, laundry };
constexpr std::size_t shaft = 1;  // among the joints

scene::Scene washing_machine() {
  return launch::read_scene(std::filesystem::path(TANDEM_SCENES) / "washing_machine.json").scene;
}

Vector3d vec(Vec3d v) {
  return {v.x, v.y, v.z};
}
Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}
Matrix3d inertia_of(const scene::Body& body) {
  const auto& I = body.inertia;
  Matrix3d m;
  m << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  return m;
}

// Centre of mass and attitude of the tub, angle of the drum in the tub; their rates in world axes.
struct Configuration {
  Vector3d p = Vector3d::Zero();
  Matrix3d R = Matrix3d::Identity();
  double q = 0;
  // The same after a displacement, a rotation vector and an angle.
  Configuration plus(const Vector7d& x) const {
    const Vector3d turn = x.segment<3>(3);
    const double angle = turn.norm();
    Configuration c = *this;
    c.p += x.head<3>();
    if (angle > 0) c.R = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * R;
    c.q += x(6);
    return c;
  }
};

struct Model7 {
  struct Strut {
    Vector3d on_cabinet, on_tub;  // in the world; from the tub's centre of mass
    double stiffness, damping, length;
  };
  double tub_mass, rotor_mass, shaft_damping, gain, largest_torque, rotor_inertia;
  Matrix3d tub_inertia, rotor_about_centre;
  Vector3d gravity, start, to_shaft, to_rotor_centre;  // centre of the tub; from it; from the shaft's point
  std::vector<Strut> struts;

  explicit Model7(const scene::Scene& scene) {
    const auto& bodies = scene.mbd->bodies;
    const scene::Joint& joint = scene.mbd->joints[shaft];
    gravity = vec(scene.gravity);
    start = vec(bodies[tub].pose.p_WB);
    to_shaft = vec(joint.position) - start;
    shaft_damping = joint.damping;
    tub_mass = bodies[tub].mass, tub_inertia = inertia_of(bodies[tub]);
    // Drum and laundry as one body.
    rotor_mass = bodies[drum].mass + bodies[laundry].mass;
    const Vector3d drum_at = vec(bodies[drum].pose.p_WB) - vec(joint.position),
                   laundry_at = vec(bodies[laundry].pose.p_WB) - vec(joint.position);
    to_rotor_centre = (bodies[drum].mass * drum_at + bodies[laundry].mass * laundry_at) / rotor_mass;
    const auto moved = [&](const scene::Body& body, const Vector3d& at) -> Matrix3d {
      const Matrix3d d = skew(at - to_rotor_centre);
      return inertia_of(body) - body.mass * d * d;
    };
    rotor_about_centre = moved(bodies[drum], drum_at) + moved(bodies[laundry], laundry_at);
    for (const scene::Force& force : scene.mbd->forces) {
      if (const auto* spring = std::get_if<scene::SpringDamper>(&force)) {
        struts.push_back({vec(spring->point_a), vec(spring->point_b) - start, spring->stiffness,
                          spring->damping, spring->length});
      } else {
        const auto& motor = std::get<scene::Motor>(force);
        gain = motor.gains.proportional, largest_torque = *motor.max_torque * motor.gear_ratio;
        rotor_inertia = motor.rotor_inertia * motor.gear_ratio * motor.gear_ratio;
      }
    }
  }

  // Mass matrix, and the generalised forces less the terms of the velocities.
  void equations(const Configuration& c, const Vector7d& u, double target, Matrix7d& M, Vector7d& f) const {
    const Vector3d v = u.head<3>(), w = u.segment<3>(3);
    const double rate = u(6);
    const Matrix3d turned = c.R * Eigen::AngleAxisd(c.q, Vector3d::UnitY()).toRotationMatrix();
    const Vector3d axis = c.R.col(1), s = c.R * to_shaft, d = turned * to_rotor_centre,
                   spin = w + rate * axis;
    const Matrix3d tub_I = c.R * tub_inertia * c.R.transpose(),
                   I = turned * rotor_about_centre * turned.transpose();

    Eigen::Matrix<double, 3, 7> velocity = Eigen::Matrix<double, 3, 7>::Zero(), rotation = velocity;
    velocity.leftCols<3>().setIdentity();
    velocity.middleCols<3>(3) = -skew(s + d);
    velocity.col(6) = axis.cross(d);
    rotation.middleCols<3>(3).setIdentity();
    rotation.col(6) = axis;
    const Vector3d turning = rate * w.cross(axis);  // acceleration at rates that do not change
    const Vector3d bent = w.cross(w.cross(s)) + turning.cross(d) + spin.cross(spin.cross(d));

    M.setZero();
    M.topLeftCorner<3, 3>() = tub_mass * Matrix3d::Identity();
    M.block<3, 3>(3, 3) = tub_I;
    M += rotor_mass * velocity.transpose() * velocity + rotation.transpose() * I * rotation;
    M(6, 6) += rotor_inertia;

    f.setZero();
    f.head<3>() = tub_mass * gravity;
    f.segment<3>(3) = -w.cross(tub_I * w);
    f += velocity.transpose() * (rotor_mass * (gravity - bent)) -
         rotation.transpose() * (I * turning + spin.cross(I * spin));
    for (const Strut& strut : struts) {
      const Vector3d arm = c.R * strut.on_tub, line = c.p + arm - strut.on_cabinet, n = line.normalized();
      const double force =
          strut.stiffness * (line.norm() - strut.length) + strut.damping * n.dot(v + w.cross(arm));
      f.head<3>() -= force * n;
      f.segment<3>(3) -= arm.cross(force * n);
    }
    f(6) += std::clamp(gain * (target - rate), -largest_torque, largest_torque) - shaft_damping * rate;
  }
  Vector7d acceleration(const Configuration& c, const Vector7d& u, double target) const {
    Matrix7d M;
    Vector7d f;
    equations(c, u, target, M, f);
    return M.ldlt().solve(f);
  }

  struct Linear {
    Matrix7d M, C, K;
  };
  // By central differences about a configuration and its rates.
  Linear linear(const Configuration& c, const Vector7d& u, double target) const {
    Linear l;
    Vector7d f, plus, minus;
    Matrix7d other;
    equations(c, u, target, l.M, f);
    const double e = 1e-5;
    for (int k = 0; k < 7; ++k) {
      const Vector7d x = e * Vector7d::Unit(k);
      equations(c.plus(x), u, target, other, plus), equations(c.plus(-x), u, target, other, minus);
      l.K.col(k) = -(plus - minus) / (2 * e);
      equations(c, u + x, target, other, plus), equations(c, u - x, target, other, minus);
      l.C.col(k) = -(plus - minus) / (2 * e);
    }
    return l;
  }

  Configuration equilibrium() const {
    Configuration c;
    c.p = start;
    for (int i = 0; i < 20; ++i) {
      Matrix7d M;
      Vector7d f;
      equations(c, Vector7d::Zero(), 0, M, f);
      c = c.plus(linear(c, Vector7d::Zero(), 0).K.fullPivLu().solve(f));
    }
    return c;
  }

  // Steady vibration of the tub at a speed of the drum: complex amplitudes of its displacement and rotation.
  Eigen::VectorXcd vibration(const Configuration& rest, double speed) const {
    using Matrix6d = Eigen::Matrix<double, 6, 6>;
    constexpr int parts = 24;
    Matrix6d M = Matrix6d::Zero(), C = M, K = M;
    Eigen::VectorXcd F = Eigen::VectorXcd::Zero(6);
    Vector7d u = Vector7d::Zero();
    u(6) = speed;
    for (int k = 0; k < parts; ++k) {
      Configuration c = rest;
      c.q = 2 * pi * k / parts;
      const Linear l = linear(c, u, speed);
      M += l.M.topLeftCorner<6, 6>() / parts;
      C += l.C.topLeftCorner<6, 6>() / parts;
      K += l.K.topLeftCorner<6, 6>() / parts;
      Matrix7d mass;
      Vector7d f;
      equations(c, u, speed, mass, f);
      F += f.head<6>() * std::polar(2.0 / parts, -c.q);
    }
    const std::complex<double> i{0, 1};
    return (-speed * speed * M + i * speed * C + K).lu().solve(F);
  }
};

// Runge-Kutta of the nonlinear model: displacement and rotation vector of the tub from its rest, and the
// drum's rate, at the end of each window.
struct Motion {
  std::vector<std::array<double, 7>> x;
};
Motion integrate(const Model7& model, const Configuration& rest, const std::function<double(double)>& target,
                 double window, int windows, int parts) {
  Motion motion;
  Configuration c = rest;
  Vector7d u = Vector7d::Zero();
  const double h = window / parts;
  const auto at = [&](double t, const Vector7d& x, const Vector7d& rate) {
    return model.acceleration(c.plus(x), rate, target(t));
  };
  for (int n = 0; n <= windows; ++n) {
    const Eigen::AngleAxisd turn(c.R * rest.R.transpose());
    const Vector3d a = turn.angle() * turn.axis(), p = c.p - rest.p;
    motion.x.push_back({p.x(), p.y(), p.z(), a.x(), a.y(), a.z(), u(6)});
    for (int i = 0; i < parts; ++i) {
      const double t = n * window + i * h;
      // Within a step the rotation vector changes by its angular velocity, up to terms of h^4 in its third
      // power.
      const auto rate_of = [](const Vector7d& x, Vector7d v) {
        const Vector3d turned = x.segment<3>(3), w = v.segment<3>(3);
        v.segment<3>(3) += -turned.cross(w) / 2 + turned.cross(turned.cross(w)) / 12;
        return v;
      };
      const Vector7d zero = Vector7d::Zero();
      const Vector7d k1 = at(t, zero, u), x2 = h / 2 * u, u2 = u + h / 2 * k1, k2 = at(t + h / 2, x2, u2);
      const Vector7d v2 = rate_of(x2, u2), x3 = h / 2 * v2, u3 = u + h / 2 * k2, k3 = at(t + h / 2, x3, u3);
      const Vector7d v3 = rate_of(x3, u3), x4 = h * v3, u4 = u + h * k3, k4 = at(t + h, x4, u4);
      const Vector7d v4 = rate_of(x4, u4);
      c = c.plus(h / 6 * (u + 2 * v2 + 2 * v3 + v4));
      u += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
  }
  return motion;
}

// As the model counts them, from a run.
std::array<double, 7> of_run(const protocol::BodiesFrame& frame, const protocol::BodiesFrame& first) {
  const Pose now = frame.bodies[tub].pose, rest = first.bodies[tub].pose;
  const Vec3d p = now.p_WB - rest.p_WB, a = rotation_vector(now.q_WB * rest.q_WB.conjugate());
  return {p.x, p.y, p.z, a.x, a.y, a.z, frame.joints[shaft].rate};
}

constexpr const char* names[] = {
    "tub, sideways [m]",     "tub, along the shaft [m]", "tub, vertical [m]",        "tub, rotation about x",
    "tub, rotation about y", "tub, rotation about z",    "speed of the drum [rad/s]"};

TEST(WashingMachineScene, MovesLikeTheRigidBodyModel) {
  const scene::Scene scene = washing_machine();
  const Model7 model(scene);
  const double window = scene.coupling.window;
  const int windows = static_cast<int>(std::round(scene.end_time / window));
  const auto& motor = std::get<scene::Motor>(scene.mbd->forces.back());
  // The target of a speed is a coordinate: its table begins and ends at rest.
  const scene::MotionFunction programme(motor.target, scene::FunctionOf::coordinate);
  const Configuration rest = model.equilibrium();
  const Motion exact = integrate(
      model, rest, [&](double t) { return programme.at(t).value; }, window, windows, 10);
  const RecordedRun run = record(scene, scene.end_time, windows);

  Comparison at_rest("Washing machine, static equilibrium");
  for (const char* name : {"tub, sideways [m]", "tub, along the shaft [m]", "tub, vertical [m]"})
    at_rest.add(name, 1e-9);
  const Vec3d position = run.frames.front().bodies[tub].pose.p_WB;
  for (int k = 1; k < 3; ++k) at_rest.at(static_cast<std::size_t>(k), rest.p(k), position[k]);
  at_rest.at(0, rest.p.x() + 1, position.x + 1);
  at_rest.expect();

  Comparison table("Washing machine, whole programme");
  for (std::size_t k = 0; k < 7; ++k) table.add(names[k], k < 6 ? 1e-3 : 1e-6);
  for (std::size_t n = 0; n < run.frames.size(); ++n) {
    const auto measured = of_run(run.frames[n], run.frames.front());
    for (std::size_t k = 0; k < 7; ++k) table.at(k, exact.x[n][k], measured[k]);
  }
  table.expect();
}

// Half the range of a signal of the tub or the drum from a row on.
template <class Rows>
double amplitude_from(const Rows& rows, std::size_t first, std::size_t k) {
  double low = rows.at(first)[k], high = low;
  for (std::size_t n = first; n < rows.size(); ++n)
    low = std::min(low, rows[n][k]), high = std::max(high, rows[n][k]);
  return (high - low) / 2;
}

// Amplitude of the tub over the speed: by the linear model, by the nonlinear one, and in runs that hold the
// speed.
TEST(WashingMachineScene, HasTheCriticalSpeedsOfTheLinearModel) {
  const scene::Scene given = washing_machine();
  const Model7 model(given);
  const Configuration rest = model.equilibrium();
  const double damping = given.mbd->joints[shaft].damping;
  const struct {
    std::size_t coordinate;
    const char* name;
    std::vector<double> speeds;  // [rpm]
  } cases[] = {{0, "sideways", {60, 105, 110, 115, 240, 1200}},
               {2, "vertical", {60, 177, 187, 197, 300, 1200}}};
  Comparison linear("Washing machine, amplitude of the steady vibration, linear model"),
      nonlinear("Washing machine, amplitude of the steady vibration, nonlinear model");
  for (const auto& [k, name, speeds] : cases) {
    const auto of_linear = [&](double speed) {
      return std::abs(model.vibration(rest, speed * rpm)(static_cast<Eigen::Index>(k)));
    };
    double critical = 0, most = 0, most_at = 0;
    for (double speed = 60; speed < 400; ++speed)
      if (of_linear(speed) > of_linear(critical)) critical = speed;
    for (const double speed : speeds) {
      const double w = speed * rpm, period = 2 * pi / w, end = 10 + std::ceil(2 * period);
      // The motor has no integral part, and drives against the damping of the shaft.
      const scene::RampMotion target{0, w * (1 + damping / model.gain), 0, 2};
      const scene::MotionFunction programme(target, scene::FunctionOf::force);
      scene::Scene scene = given;
      std::get<scene::Motor>(scene.mbd->forces.back()).target = target;
      const int windows = static_cast<int>(end / std::min(.01, period / 40));
      const double window = end / windows;
      const RecordedRun run = record(scene, end, windows);
      std::vector<std::array<double, 7>> rows;
      for (const protocol::BodiesFrame& frame : run.frames) rows.push_back(of_run(frame, run.frames.front()));
      const Motion exact = integrate(
          model, rest, [&](double t) { return programme.at(t).value; }, window, windows,
          static_cast<int>(window / 1e-3) + 1);
      const std::size_t settled = static_cast<std::size_t>(10 / window);
      const double measured = amplitude_from(rows, settled, k);
      const std::string text =
          std::string(name) + " at " + std::to_string(static_cast<int>(speed)) + " rpm [m]";
      // An amplitude of 18 mm is a tenth of the length of the springs.
      linear.add(text, of_linear(speed) > .01 ? .05 : .01);
      linear.at(linear.rows() - 1, of_linear(speed), measured);
      nonlinear.add(text, 1e-3);
      nonlinear.at(nonlinear.rows() - 1, amplitude_from(exact.x, settled, k), measured);
      if (measured > most) most = measured, most_at = speed;
    }
    std::printf(
        "largest amplitude %s: %.4g mm at %g rpm by the linear model, %.4g mm at %g rpm in the runs\n", name,
        1e3 * of_linear(critical), critical, 1e3 * most, most_at);
    EXPECT_NEAR(most_at, critical, 5);
  }
  linear.expect();
  nonlinear.expect();

  // The figures in the scene's checks are those of the model.
  const double mass = model.tub_mass + model.rotor_mass;
  const Vector3d& off = model.to_rotor_centre;
  const double far_above = 2 * model.rotor_mass * std::hypot(off.x(), off.z()) / mass;
  const auto& motor = std::get<scene::Motor>(given.mbd->forces.back());
  const std::vector<std::pair<std::string, double>> figures{
      {"shaft.rate mean", 1200 * rpm * motor.gains.proportional / (motor.gains.proportional + damping)},
      {"tub.position.z range", 2 * std::abs(model.vibration(rest, 187 * rpm)(2))},
      {"tub.position.z range", far_above},
      {"tub.position.x range", far_above},
      {"feet.reaction_force.z mean", (mass + given.mbd->bodies[cabinet].mass) * -model.gravity.z()}};
  expect_figures_of_checks(given, figures);
}

TEST(WashingMachineScene, HasTheModesOfTheLinearModel) {
  const scene::Scene scene = washing_machine();
  const Model7 model(scene);
  const Model7::Linear l = model.linear(model.equilibrium(), Vector7d::Zero(), 0);
  Eigen::Matrix<double, 14, 14> A = Eigen::Matrix<double, 14, 14>::Zero();
  A.topRightCorner<7, 7>().setIdentity();
  A.bottomLeftCorner<7, 7>() = -l.M.ldlt().solve(l.K);
  A.bottomRightCorner<7, 7>() = -l.M.ldlt().solve(l.C);
  std::vector<std::complex<double>> roots;
  for (const std::complex<double> s :
       Eigen::EigenSolver<Eigen::Matrix<double, 14, 14>>(A, false).eigenvalues())
    if (s.imag() >= 0) roots.push_back(s);
  std::sort(roots.begin(), roots.end(), [](auto a, auto b) { return std::abs(a) < std::abs(b); });

  machines::Run run(scene, 1e-3);
  run.state.u.setZero();
  find_equilibrium(run.model, run.system, run.state);
  const Modes modes = find_modes(run.model, run.system, run.state);
  ASSERT_EQ(modes.modes.size(), roots.size());
  Comparison table("Washing machine, natural modes as tandem modes prints them");
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    const bool oscillates = roots[i].imag() > 0;
    table.add("mode " + number + (oscillates ? ", frequency [Hz]" : ", decay [1/s]"), 1e-7);
    table.at(table.rows() - 1, oscillates ? std::abs(roots[i]) / (2 * pi) : -roots[i].real(),
             oscillates ? modes.modes[i].frequency() : -modes.modes[i].s.real());
    if (!oscillates) continue;
    table.add("mode " + number + ", damping ratio", 1e-7);
    table.at(table.rows() - 1, -roots[i].real() / std::abs(roots[i]), modes.modes[i].damping_ratio());
  }
  table.expect();
}

}  // namespace washing_machine_test
}  // namespace tandem::mbd
