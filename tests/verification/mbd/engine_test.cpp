// launch/scenes/engine.json against the inverse dynamics of a slider-crank, derived here by hand, and its
// speed against the equation of motion with one degree of freedom, J(q) q'' + J'(q) q'^2 / 2 = M(q, q').
//
// The crank turns by q about x; y is across and z along the cylinders. A pin at angle a = q, or q + pi, is at
// r (-sin a, cos a); the rod points along (sin b, cos b) with l sin b = r sin a.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "coordinator/scene/scene_file.hpp"
#include "mbd_server/model/periodic_curve.hpp"
#include "tests/verification/mbd/comparison.hpp"
#include "tests/verification/mbd/recorded_run.hpp"

namespace tandem::mbd {
namespace engine_test {

constexpr double pi = std::numbers::pi;
constexpr int cylinders = 4;

scene::Scene engine_scene() {
  return launch::read_scene(std::filesystem::path(TANDEM_SCENES) / "engine.json").scene;
}

PeriodicCurve curve_of(const scene::JointFunction& over) {
  return {over.table.arguments, over.table.values, over.period, PeriodicCurve::Smoothness::slope};
}

// Position, and its first and second derivative with respect to the crank angle.
struct Along {
  double value, first, second;
  double acceleration(double rate, double rate_dot) const { return second * rate * rate + first * rate_dot; }
};

struct Engine {
  double r, l, g;
  double crank_mass, crank_inertia, crank_centre;  // of mass along x
  double rod_mass, rod_inertia, rod_centre;        // from the big end
  double piston_mass;
  std::array<double, cylinders> x, phase;
  std::array<PeriodicCurve, cylinders> gas;  // [N] over the crank angle
  PeriodicCurve brake;                       // [N m] over the crank's rate

  explicit Engine(const scene::Scene& scene) {
    const auto& bodies = scene.mbd->bodies;  // the crankshaft, then a rod and a piston per cylinder
    const auto& joints = scene.mbd->joints;  // the crank, then big end, small end and liner per cylinder
    g = -scene.gravity.z;
    crank_mass = bodies[0].mass, crank_inertia = bodies[0].inertia[0], crank_centre = bodies[0].pose.p_WB.x;
    rod_mass = bodies[1].mass, rod_inertia = bodies[1].inertia[0], piston_mass = bodies[2].mass;
    r = joints[1].position.z;
    l = joints[2].position.z - r;
    rod_centre = bodies[1].pose.p_WB.z - r;
    for (std::size_t k = 0; k < cylinders; ++k) {
      x[k] = joints[3 * k + 1].position.x;
      phase[k] = joints[3 * k + 1].position.z > 0 ? 0 : pi;
      gas[k] = curve_of(*std::get<scene::BodyLoad>(scene.mbd->forces[k]).over);
    }
    brake = curve_of(*std::get<scene::Actuator>(scene.mbd->forces[cylinders]).over);
  }

  struct Kinematics {
    Along pin_y, pin_z, rod_y, rod_z, piston_z, b;
  };
  Kinematics kinematics(double a) const {
    const double s = std::sin(a), c = std::cos(a), sb = r * s / l, cb = std::sqrt(1 - sb * sb);
    const double b1 = r * c / (l * cb), b2 = (sb * b1 * b1 - r * s / l) / cb;
    const Along along_y{sb, cb * b1, cb * b2 - sb * b1 * b1}, along_z{cb, -sb * b1, -sb * b2 - cb * b1 * b1};
    const auto plus = [](Along u, double f, Along v) {
      return Along{u.value + f * v.value, u.first + f * v.first, u.second + f * v.second};
    };
    Kinematics k;
    k.b = {std::asin(sb), b1, b2};
    k.pin_y = {-r * s, -r * c, r * s}, k.pin_z = {r * c, -r * s, -r * c};
    k.rod_y = plus(k.pin_y, rod_centre, along_y), k.rod_z = plus(k.pin_z, rod_centre, along_z);
    k.piston_z = plus(k.pin_z, l, along_z);
    return k;
  }

  // Generalised inertia, half its derivative, and torque of gas and weights at the crank.
  struct Reduced {
    double J, half_dJ, torque;
    double rate_dot(double rate, double brake_torque) const {
      return (torque + brake_torque - half_dJ * rate * rate) / J;
    }
  };
  Reduced reduced(double q) const {
    Reduced sum{crank_inertia, 0, 0};
    for (std::size_t i = 0; i < cylinders; ++i) {
      const Kinematics k = kinematics(q + phase[i]);
      const auto add = [&](double mass, const Along& u) {
        sum.J += mass * u.first * u.first, sum.half_dJ += mass * u.first * u.second;
      };
      add(piston_mass, k.piston_z), add(rod_mass, k.rod_y), add(rod_mass, k.rod_z), add(rod_inertia, k.b);
      sum.torque -= (gas[i].at(q).value + piston_mass * g) * k.piston_z.first + rod_mass * g * k.rod_z.first;
    }
    return sum;
  }

  struct Forces {
    double torque = 0;                            // on the crank, through its joint [N m]
    double main_y = 0, main_z = 0;                // on the crank in the main bearing [N]
    double main_moment_y = 0, main_moment_z = 0;  // about the origin [N m]
    std::array<double, cylinders> side{};         // of the liner on the piston [N]
    std::array<double, cylinders> pin{};          // size of the force of the crank on the rod [N]
  };
  Forces inverse_dynamics(double q, double rate, double rate_dot) const {
    Forces f;
    f.main_z = crank_mass * g;
    f.torque = crank_inertia * rate_dot;
    f.main_moment_y = -crank_centre * crank_mass * g;
    for (std::size_t i = 0; i < cylinders; ++i) {
      const Kinematics k = kinematics(q + phase[i]);
      const double sb = std::sin(k.b.value), cb = std::cos(k.b.value);
      // The rod turns by -b about x.
      const double turning = rod_inertia * -k.b.acceleration(rate, rate_dot);
      const double small_z = piston_mass * (k.piston_z.acceleration(rate, rate_dot) + g) + gas[i].at(q).value;
      const double inertia_y = rod_mass * k.rod_y.acceleration(rate, rate_dot),
                   inertia_z = rod_mass * (k.rod_z.acceleration(rate, rate_dot) + g);
      const double big_z = inertia_z + small_z;
      // Moments about the rod's centre of mass, with small = -small_y on the rod and big_y = inertia_y +
      // small_y.
      const double to_small = l - rod_centre;
      const double small_y =
          (turning + to_small * sb * small_z + rod_centre * (sb * big_z - cb * inertia_y)) / (l * cb);
      const double big_y = inertia_y + small_y;
      f.side[i] = -small_y;
      f.pin[i] = std::hypot(big_y, big_z);
      f.main_y += big_y, f.main_z += big_z;
      f.torque += k.pin_y.value * big_z - k.pin_z.value * big_y;
      f.main_moment_y -= x[i] * big_z, f.main_moment_z += x[i] * big_y;
    }
    return f;
  }
};

// What the run has, beside the forces of the model at the same instants.
void compare(Comparison& table, const Engine& engine, const RecordedRun& run, double from,
             const std::function<std::array<double, 3>(double)>& crank_at, double force_tolerance) {
  const std::size_t first = table.rows();
  table.add("torque on the crank [N m]", force_tolerance);
  table.add("main bearing, force across [N]", force_tolerance);
  table.add("main bearing, force along [N]", force_tolerance);
  table.add("main bearing, moment about y [N m]", force_tolerance);
  table.add("main bearing, moment about z [N m]", force_tolerance);
  for (int k = 1; k <= cylinders; ++k)
    table.add("side force of piston " + std::to_string(k) + " [N]", force_tolerance);
  for (int k = 1; k <= cylinders; ++k)
    table.add("force on crank pin " + std::to_string(k) + " [N]", force_tolerance);
  for (const protocol::BodiesFrame& frame : run.frames) {
    const double t = to_seconds(frame.time);
    if (t < from) continue;
    const auto [q, rate, rate_dot] = crank_at(t);
    const Engine::Forces f = engine.inverse_dynamics(q, rate, rate_dot);
    const auto reaction = [&](std::size_t joint) { return frame.joints[joint].reaction; };
    std::size_t row = first;
    table.at(row++, f.torque, reaction(0).torque.x);
    table.at(row++, f.main_y, reaction(0).force.y);
    table.at(row++, f.main_z, reaction(0).force.z);
    table.at(row++, f.main_moment_y, reaction(0).torque.y);
    table.at(row++, f.main_moment_z, reaction(0).torque.z);
    for (std::size_t k = 0; k < cylinders; ++k) table.at(row++, f.side[k], reaction(3 * k + 3).force.y);
    for (std::size_t k = 0; k < cylinders; ++k) table.at(row++, f.pin[k], norm(reaction(3 * k + 1).force));
  }
}

// The crank turns as prescribed, from 1000 to 3000 rpm within a tenth of a second.
TEST(EngineScene, HasTheTorqueAndTheBearingForcesOfInverseDynamics) {
  scene::Scene scene = engine_scene();
  const Engine engine(scene);
  const double from = 1000 * pi / 30, to = 3000 * pi / 30, duration = .1;
  scene::RampMotion ramp{from, to, 0, duration};
  ramp.of = scene::MotionOf::speed;
  scene.mbd->joints[0].rate = 0;
  scene.mbd->joints[0].motion = ramp;
  scene.mbd->forces.pop_back();  // the brake

  const auto crank_at = [&](double t) {
    const double s = t / duration, c = to - from;
    return std::array{from * t + c * duration * s * s * s * s * (2.5 + s * (s - 3)),
                      from + c * s * s * s * (10 + s * (6 * s - 15)),
                      30 * c / duration * s * s * (1 - s) * (1 - s)};
  };
  Comparison table("Engine, crank prescribed from 1000 to 3000 rpm, against inverse dynamics");
  compare(table, engine, record(scene, duration, 400), 0, crank_at, 1e-4);
  table.expect();
}

// The run of the scene itself.
TEST(EngineScene, RunsUpLikeItsEquationWithOneFreedom) {
  const scene::Scene scene = engine_scene();
  const Engine engine(scene);
  const double window = scene.coupling.window;
  const int windows = static_cast<int>(std::round(scene.end_time / window)), parts = 20;

  // Runge-Kutta in steps of 25 us; over the last half second the signals that the scene's checks reduce.
  std::vector<std::array<double, 3>> exact;
  double q = 0, rate = scene.mbd->joints[0].rate;
  double slowest = 1e9, fastest = 0, largest_side = 0, half_second = 0;
  const auto rate_dot = [&](double at, double speed) {
    return engine.reduced(at).rate_dot(speed, engine.brake.at(speed).value);
  };
  for (int n = 0; n <= windows; ++n) {
    exact.push_back({q, rate, rate_dot(q, rate)});
    if (n * window >= scene.end_time - .5) {
      if (half_second == 0) half_second = q;
      slowest = std::min(slowest, rate), fastest = std::max(fastest, rate);
    }
    const double h = window / parts;
    for (int i = 0; i < parts && n < windows; ++i) {
      const double k1 = rate_dot(q, rate), k2 = rate_dot(q + h / 2 * rate, rate + h / 2 * k1),
                   k3 = rate_dot(q + h / 2 * rate + h * h / 4 * k1, rate + h / 2 * k2),
                   k4 = rate_dot(q + h * rate + h * h / 2 * k2, rate + h * k3);
      q += h * rate + h * h / 6 * (k1 + k2 + k3);
      rate += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      if (half_second > 0)
        largest_side = std::min(largest_side, engine.inverse_dynamics(q, rate, rate_dot(q, rate)).side[0]);
    }
  }
  // Work of the gas in a cycle, and its mean force on all pistons.
  double cycle_work = 0, gas_force = 0, weight = engine.crank_mass * engine.g;
  constexpr int parts_of_cycle = 72000;
  for (int n = 0; n < parts_of_cycle; ++n) {
    const double at = n * 4 * pi / parts_of_cycle;
    cycle_work += engine.reduced(at).torque * 4 * pi / parts_of_cycle;
    for (const PeriodicCurve& gas : engine.gas) gas_force += gas.at(at).value / parts_of_cycle;
  }
  weight += cylinders * (engine.rod_mass + engine.piston_mass) * engine.g;

  const RecordedRun run = record(scene, scene.end_time, windows);
  Comparison table("Engine, running up against its brake");
  table.add("crank angle [rad]", 5e-6);
  table.add("speed [rad/s]", 5e-5);
  for (std::size_t n = 0; n < run.frames.size(); ++n) {
    table.at(0, exact[n][0], run.frames[n].joints[0].q);
    table.at(1, exact[n][1], run.frames[n].joints[0].rate);
  }
  compare(
      table, engine, run, 0,
      [&](double t) { return exact[static_cast<std::size_t>(std::round(t / window))]; }, 2e-3);
  table.expect();

  // The figures in the scene's checks are those of the model.
  const auto& brake = std::get<scene::Actuator>(scene.mbd->forces[cylinders]).over->table;
  const double factor = -brake.values.back() / (brake.arguments.back() * brake.arguments.back());
  const std::vector<std::pair<std::string, double>> figures{
      {"crank.rate mean", std::sqrt(cycle_work / (4 * pi * factor))},
      {"crank.rate range", fastest - slowest},
      {"crank.reaction_torque.x mean", -cycle_work / (4 * pi)},
      {"crank.reaction_force.z mean", gas_force + weight},
      {"liner_1.reaction_force.y min", largest_side},
      {"piston_1.position.z range", 2 * engine.r}};
  expect_figures_of_checks(scene, figures);
}

}  // namespace engine_test
}  // namespace tandem::mbd
