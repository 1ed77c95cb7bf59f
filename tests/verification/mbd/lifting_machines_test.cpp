// The excavator arm, the fork mast and the winch of launch/scenes against models of their own: the equations
// of motion written by hand, integrated by Runge and Kutta's method in fine steps. Masses and points are
// those of the files.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/scene/motion_function.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace {

constexpr double g = 9.81;

scene::Scene machine(const std::string& name) {
  return launch::read_scene(std::string(TANDEM_SCENES) + "/" + name + ".json").scene;
}

template <class Force>
const Force& force_of(const scene::Scene& scene, const std::string& name) {
  for (const scene::Force& force : scene.mbd->forces)
    if (const auto* f = std::get_if<Force>(&force); f && f->name == name) return *f;
  throw std::runtime_error("there is no force " + name);
}

// The run, window by window, seen at the end of each.
struct SeenRun {
  MbdSolver solver;
  std::int64_t window, end;

  explicit SeenRun(const scene::Scene& scene)
      : window(to_nanoseconds(scene.coupling.window).count), end(to_nanoseconds(scene.end_time).count) {
    solver.configure(scene);
  }
  // `see` receives the time and the state.
  void go(const std::function<void(double, const State&)>& see) {
    for (std::int64_t t = 0; t < end; t += window) {
      protocol::LoadSet loads;
      loads.window = {static_cast<std::uint64_t>(t / window), {t}, {t + window}};
      solver.advance(loads);
      see(1e-9 * static_cast<double>(t + window), solver.state());
    }
  }
};

template <std::size_t n>
using Rates = std::function<std::array<double, n>(double, const std::array<double, n>&)>;

template <std::size_t n>
std::array<double, n> stepped(const std::array<double, n>& y, double t, double h, const Rates<n>& f) {
  const auto moved = [&](double by, const std::array<double, n>& d) {
    auto x = y;
    for (std::size_t i = 0; i < n; ++i) x[i] += by * d[i];
    return x;
  };
  const auto a = f(t, y), b = f(t + h / 2, moved(h / 2, a)), c = f(t + h / 2, moved(h / 2, b)),
             d = f(t + h, moved(h, c));
  auto x = y;
  for (std::size_t i = 0; i < n; ++i) x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  return x;
}

// Largest differences over the run, beside the largest value.
class Comparison {
 public:
  explicit Comparison(const char* machine) : machine_(machine) {}
  void see(const std::string& what, double measured, double expected) {
    for (Row& row : rows_)
      if (row.what == what) return row.take(measured, expected);
    rows_.push_back({what});
    rows_.back().take(measured, expected);
  }
  // Every quantity within `share` of its largest value.
  void expect_within(double share) const {
    std::printf("%-14s %-28s %14s %14s %12s %12s\n", machine_, "", "largest", "at the end", "difference",
                "tolerance");
    for (const Row& row : rows_) {
      std::printf("%-14s %-28s %14.6g %14.6g %12.2e %12.2e\n", "", row.what.c_str(), row.largest, row.last,
                  row.difference, share * row.largest);
      EXPECT_LT(row.difference, share * row.largest) << row.what;
    }
  }

 private:
  struct Row {
    std::string what;
    double largest = 0, last = 0, difference = 0;
    void take(double measured, double expected) {
      largest = std::max(largest, std::abs(expected));
      last = expected;
      difference = std::max(difference, std::abs(measured - expected));
    }
  };
  const char* machine_;
  std::vector<Row> rows_;
};

void expect_close(const char* what, double measured, double expected, double tolerance) {
  std::printf("  %-58s expected %14.8g measured %14.8g tolerance %8.1e\n", what, expected, measured,
              tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

// ---- excavator arm

struct Plane {
  double x = 0, z = 0;
  Plane operator+(Plane o) const { return {x + o.x, z + o.z}; }
  Plane operator-(Plane o) const { return {x - o.x, z - o.z}; }
  double dot(Plane o) const { return x * o.x + z * o.z; }
  Plane turned(double angle) const {
    return {std::cos(angle) * x - std::sin(angle) * z, std::sin(angle) * x + std::cos(angle) * z};
  }
  Plane left() const { return {-z, x}; }  // rate of turning
};
Plane plane(Vec3d v) {
  return {v.x, v.z};
}

// Boom and stick as a double pendulum of the elevations a and b from the start, and two cylinders with two
// pressures each.
struct ExcavatorArm {
  scene::Scene scene = machine("excavator_arm");
  scene::Cylinder lift = force_of<scene::Cylinder>(scene, "lift"),
                  crowd = force_of<scene::Cylinder>(scene, "crowd");
  scene::MotionFunction lift_opening{lift.target, scene::FunctionOf::force},
      crowd_opening{crowd.target, scene::FunctionOf::force};
  Plane foot = plane(scene.mbd->joints[1].position), elbow = plane(scene.mbd->joints[2].position) - foot;
  double boom_mass = 0, arm_mass = 0, boom_inertia = 0, arm_inertia = 0;  // arm: stick and bucket
  Plane boom_centre, arm_centre;                                          // at the start, from foot and elbow

  using Y = std::array<double, 8>;  // a, b, rates, pressures of lift and crowd

  ExcavatorArm() {
    const auto &boom = scene.mbd->bodies[1], &stick = scene.mbd->bodies[2], &bucket = scene.mbd->bodies[3];
    boom_mass = boom.mass, arm_mass = stick.mass + bucket.mass;
    boom_centre = plane(boom.pose.p_WB) - foot;
    const Plane at = foot + elbow, s = plane(stick.pose.p_WB) - at, k = plane(bucket.pose.p_WB) - at;
    arm_centre = {(stick.mass * s.x + bucket.mass * k.x) / arm_mass,
                  (stick.mass * s.z + bucket.mass * k.z) / arm_mass};
    boom_inertia = boom.inertia[1] + boom.mass * boom_centre.dot(boom_centre);
    arm_inertia = stick.inertia[1] + stick.mass * s.dot(s) + bucket.inertia[1] + bucket.mass * k.dot(k);
  }

  // Length of a cylinder, and its derivatives by a and b.
  struct Line {
    double length = 0, by_a = 0, by_b = 0;
  };
  Line line_of(Plane p, Plane p_a, Plane p_b, Plane q, Plane q_a, Plane q_b) const {
    const Plane d = q - p;
    const double length = std::sqrt(d.dot(d));
    return {length, d.dot(q_a - p_a) / length, d.dot(q_b - p_b) / length};
  }
  Line lift_line(double a) const {
    const Plane q = (plane(lift.point_b) - foot).turned(a);
    return line_of(plane(lift.point_a), {}, {}, foot + q, q.left(), {});
  }
  Line crowd_line(double a, double b) const {
    const Plane p = (plane(crowd.point_a) - foot).turned(a), e = elbow.turned(a),
                q = (plane(crowd.point_b) - foot - elbow).turned(b);
    return line_of(foot + p, p.left(), {}, foot + e + q, e.left(), q.left());
  }
  // Moments of the weight about foot and elbow.
  std::array<double, 2> weight(double a, double b) const {
    return {-g * (boom_mass * boom_centre.turned(a).x + arm_mass * elbow.turned(a).x),
            -g * arm_mass * arm_centre.turned(b).x};
  }
  // Forces of both cylinders at rest, by the balance of moments.
  std::array<double, 2> holding(double a, double b) const {
    const auto [Q1, Q2] = weight(a, b);
    const Line l = lift_line(a), c = crowd_line(a, b);
    const double crowd_force = -Q2 / c.by_b;
    return {-(Q1 + crowd_force * c.by_a) / l.by_a, crowd_force};
  }

  static double edge(const scene::HydraulicData& oil, double x, double drop) {
    const double d = oil.laminar_drop,
                 K = oil.valve_flow * std::pow(oil.valve_drop * oil.valve_drop + d * d, .25) / oil.valve_drop;
    return K * x * drop / std::pow(drop * drop + d * d, .25);
  }
  struct Oil {
    double force = 0, rate_a = 0, rate_b = 0;
  };
  static Oil oil_of(const scene::Cylinder& c, double x, double stroke, double v, double pa, double pb) {
    const scene::HydraulicData& oil = *c.hydraulics;
    const double Aa = oil.bore_area, Ab = oil.bore_area - oil.rod_area;
    double Qa = x >= 0 ? edge(oil, x, oil.supply_pressure - pa) : edge(oil, -x, oil.tank_pressure - pa);
    double Qb = x >= 0 ? edge(oil, x, oil.tank_pressure - pb) : edge(oil, -x, oil.supply_pressure - pb);
    double& fed = x >= 0 ? Qa : Qb;
    fed = std::min(fed, *oil.pump_flow);
    return {Aa * pa - Ab * pb - c.damping * v,
            oil.bulk_modulus / (oil.dead_volume + Aa * (stroke - c.limits->lower)) * (Qa - Aa * v),
            oil.bulk_modulus / (oil.dead_volume + Ab * (c.limits->upper - stroke)) * (Qb + Ab * v)};
  }
  Y rates(double t, const Y& y) const {
    const double a = y[0], b = y[1], u = y[2], v = y[3];
    const Line l = lift_line(a), c = crowd_line(a, b);
    const Oil raise =
        oil_of(lift, lift_opening.at(t).value, l.length - lift_line(0).length, l.by_a * u, y[4], y[5]);
    const Oil reach = oil_of(crowd, crowd_opening.at(t).value, c.length - crowd_line(0, 0).length,
                             c.by_a * u + c.by_b * v, y[6], y[7]);
    const auto [Q1, Q2] = weight(a, b);
    const Plane e = elbow.turned(a), s = arm_centre.turned(b);
    const double A = boom_inertia + arm_mass * elbow.dot(elbow), C = arm_inertia, B = arm_mass * e.dot(s),
                 D = -arm_mass * e.dot(s.left());  // -dB/db
    const double f1 = Q1 + raise.force * l.by_a + reach.force * c.by_a + D * v * v,
                 f2 = Q2 + reach.force * c.by_b - D * u * u, det = A * C - B * B;
    return {u,
            v,
            (C * f1 - B * f2) / det,
            (A * f2 - B * f1) / det,
            raise.rate_a,
            raise.rate_b,
            reach.rate_a,
            reach.rate_b};
  }
};

TEST(ExcavatorArm, IsThatOfTheEquationsWrittenByHand) {
  const ExcavatorArm arm;
  const auto &lift = *arm.lift.hydraulics, &crowd = *arm.crowd.hydraulics;
  ExcavatorArm::Y y{0, 0, 0, 0, *lift.pressure_a, *lift.pressure_b, *crowd.pressure_a, *crowd.pressure_b};
  SeenRun run(arm.scene);
  Comparison table("excavator arm");
  double time = 0, stroke_from = 0, stroke_to = 0;
  std::array<double, 2> before{};
  const auto forces = [&](const State& s) {
    return std::array<double, 2>{lift.bore_area * s.z[0] - (lift.bore_area - lift.rod_area) * s.z[1],
                                 crowd.bore_area * s.z[2] - (crowd.bore_area - crowd.rod_area) * s.z[3]};
  };
  run.go([&](double t, const State& s) {
    constexpr int steps = 150;
    for (int i = 0; i < steps; ++i)
      y = stepped<8>(y, time + (t - time) * i / steps, (t - time) / steps,
                     [&](double at, const ExcavatorArm::Y& x) { return arm.rates(at, x); });
    time = t;
    table.see("boom [rad]", s.q[0], y[0]);
    table.see("stick to boom [rad]", s.q[1], y[1] - y[0]);
    table.see("rate of the boom [rad/s]", s.u[0], y[2]);
    table.see("rate of the stick [rad/s]", s.u[0] + s.u[1], y[3]);
    const char* names[] = {"lift p_a [Pa]", "lift p_b [Pa]", "crowd p_a [Pa]", "crowd p_b [Pa]"};
    for (int i = 0; i < 4; ++i) table.see(names[i], s.z[i], y[4 + static_cast<std::size_t>(i)]);
    const double stroke = arm.lift_line(s.q[0]).length - arm.lift_line(0).length;
    if (std::abs(t - 2.5) < 1e-6) stroke_from = stroke;
    if (std::abs(t - 4) < 1e-6) stroke_to = stroke;
    if (std::abs(t - 1) < 1e-6) before = forces(s);
    if (std::abs(t - 12) < 1e-6) {
      const auto after = forces(s);
      const auto held = arm.holding(s.q[0], s.q[0] + s.q[1]);
      expect_close("lift cylinder after the motion [N]", after[0], held[0], 5e-3 * held[0]);
      expect_close("crowd cylinder after the motion [N]", after[1], held[1], 5e-3 * std::abs(held[1]));
    }
  });
  const auto held = arm.holding(0, 0);
  expect_close("lift cylinder before the motion [N]", before[0], held[0], 1e-5 * held[0]);
  expect_close("crowd cylinder before the motion [N]", before[1], held[1], 1e-5 * std::abs(held[1]));
  expect_close("speed of the lift cylinder, flow / area [m/s]", (stroke_to - stroke_from) / 1.5,
               *lift.pump_flow / lift.bore_area, 1e-3);
  table.expect_within(2e-4);
}

// From pressures that do not bear the arm, the equilibrium at the start compresses the oil of the closed
// chambers, V e^(p/B) = const, until both cylinders have the forces of the balance of moments; and the arm
// stays there until the valve opens.
TEST(ExcavatorArm, StartsWhereItsOilBearsIt) {
  ExcavatorArm arm;
  scene::Scene scene = arm.scene;
  for (const double more : {0., 4e6}) {
    for (scene::Force& force : scene.mbd->forces)
      if (auto* c = std::get_if<scene::Cylinder>(&force))
        *c->hydraulics->pressure_a += more, *c->hydraulics->pressure_b += more / 2;
    scene.mbd->start = scene::Start::equilibrium;
    scene.end_time = .9;
    SeenRun run(scene);
    const State start = run.solver.state();
    const double a = start.q[0], b = start.q[0] + start.q[1];
    const auto held = arm.holding(a, b);
    const std::array<const char*, 2> names{"lift", "crowd"};
    const std::array<double, 2> strokes{arm.lift_line(a).length - arm.lift_line(0).length,
                                        arm.crowd_line(a, b).length - arm.crowd_line(0, 0).length};
    std::printf("equilibrium of the arm, pressures raised by %.1e Pa: boom %.3e rad, stick %.3e rad\n", more,
                a, b);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& c = force_of<scene::Cylinder>(scene, names[i]);
      const scene::HydraulicData& oil = *c.hydraulics;
      const double Aa = oil.bore_area, Ab = oil.bore_area - oil.rod_area, s = strokes[i],
                   Va = oil.dead_volume + Aa * (s - c.limits->lower),
                   Vb = oil.dead_volume + Ab * (c.limits->upper - s);
      const double pa = start.z[static_cast<Eigen::Index>(2 * i)],
                   pb = start.z[static_cast<Eigen::Index>(2 * i + 1)];
      expect_close(names[i], Aa * pa - Ab * pb, held[i], 1e-7 * std::abs(held[i]));
      expect_close("pressure in chamber a [Pa]", pa,
                   *oil.pressure_a - oil.bulk_modulus * std::log(Va / (Va - Aa * s)), 1);
      expect_close("pressure in chamber b [Pa]", pb,
                   *oil.pressure_b - oil.bulk_modulus * std::log(Vb / (Vb + Ab * s)), 1);
    }
    double moved = 0;
    run.go([&](double, const State& s) { moved = std::max(moved, (s.q - start.q).cwiseAbs().maxCoeff()); });
    expect_close("angles in the 0.9 s before the valve opens [rad]", moved, 0, 1e-9);
  }
}

// ---- fork mast

TEST(ForkMast, IsThatOfTheEquationsWrittenByHand) {
  const scene::Scene scene = machine("fork_mast");
  const auto& lift = force_of<scene::Cylinder>(scene, "lift");
  const auto& chain = force_of<scene::Rope>(scene, "chain");
  const scene::MotionFunction target(lift.target, scene::FunctionOf::force);
  const double inner = scene.mbd->bodies[1].mass,
               lifted = scene.mbd->bodies[2].mass + scene.mbd->bodies[3].mass;
  const double k = chain.axial_stiffness / chain.length;
  double at_start = -chain.length;
  for (std::size_t i = 1; i < chain.points.size(); ++i)
    at_start += norm(chain.points[i].point - chain.points[i - 1].point);
  // Heights of inner mast and carriage above those of the file, and their rates.
  using Y = std::array<double, 4>;
  const auto tension = [&](const Y& y) {
    const double e = at_start + 2 * y[0] - y[1];
    return e > 0 ? k * e * std::max(0., 1 + chain.damping * (2 * y[2] - y[3])) : 0;
  };
  const auto push = [&](double t, const Y& y) {
    const auto r = target.at(t);
    return std::clamp(lift.gains.proportional * (r.value - y[0]) + lift.gains.derivative * (r.rate - y[2]),
                      -*lift.max_force, *lift.max_force);
  };
  const Rates<4> f = [&](double t, const Y& y) {
    const double T = tension(y);
    return Y{y[2], y[3], (push(t, y) - 2 * T) / inner - g, T / lifted - g};
  };
  // Equilibrium: T = m g, F = 2 T + weight of the inner mast.
  const double T = lifted * g, F = 2 * T + inner * g, sag = -F / lift.gains.proportional;
  Y y{sag, at_start + 2 * sag - T / k, 0, 0};
  SeenRun run(scene);
  Comparison table("fork mast");
  double time = 0, middle = 0;
  run.go([&](double t, const State& s) {
    constexpr int steps = 100;
    for (int i = 0; i < steps; ++i) y = stepped<4>(y, time + (t - time) * i / steps, (t - time) / steps, f);
    time = t;
    const Y seen{s.q[0], s.q[0] + s.q[1], s.u[0], s.u[0] + s.u[1]};
    table.see("inner mast [m]", seen[0], y[0]);
    table.see("carriage [m]", seen[1], y[1]);
    table.see("rate of the inner mast [m/s]", seen[2], y[2]);
    table.see("rate of the carriage [m/s]", seen[3], y[3]);
    table.see("tension of the chain [N]", tension(seen), tension(y));
    if (std::abs(t - .01) < 1e-9) {
      expect_close("chain at the start, m g [N]", tension(seen), T, 1e-6 * T);
      expect_close("cylinder at the start, 2 m g + inner mast [N]", push(t, seen), F, 1e-6 * F);
    }
    if (std::abs(t - 4) < 1e-9) middle = seen[3] / seen[2];
  });
  expect_close("rate of the carriage over that of the cylinder", middle, 2, 5e-4);
  table.expect_within(1e-5);
}

// ---- winch

// Angle of the drum and height of the load above those of the file, and their rates. The brake holds, slips
// or is off.
TEST(Winch, IsThatOfTheEquationsWrittenByHand) {
  const scene::Scene scene = machine("winch");
  const auto& motor = force_of<scene::Motor>(scene, "motor");
  const auto& rope = force_of<scene::Rope>(scene, "rope");
  const double m = scene.mbd->bodies[2].mass, radius = .25, n = motor.gear_ratio,
               J = scene.mbd->bodies[1].inertia[2] + n * n * motor.rotor_inertia,
               k = rope.axial_stiffness / rope.length, stall = motor.torque_speed->values[0],
               free = motor.torque_speed->arguments[1];
  double at_start = -rope.length;
  for (std::size_t i = 1; i < rope.points.size(); ++i)
    at_start += norm(rope.points[i].point - rope.points[i - 1].point);
  using Y = std::array<double, 4>;
  const auto tension = [&](const Y& y) {
    const double e = at_start + radius * y[0] - y[1];
    return e > 0 ? k * e * std::max(0., 1 + rope.damping * (radius * y[2] - y[3])) : 0;
  };
  const auto lifting = [&](const Y& y) { return n * stall * (1 - n * y[2] / free); };
  const auto model = [&](bool held, bool motor_on, double brake) -> Rates<4> {
    return [=, &tension, &lifting](double, const Y& y) {
      const double T = tension(y);
      const double torque = (motor_on ? lifting(y) : 0) - brake - radius * T;
      return held ? Y{0, y[3], 0, T / m - g} : Y{y[2], y[3], torque / J, T / m - g};
    };
  };
  const Rates<4> hold = model(true, false, 0), raise = model(false, true, 0),
                 slow = model(false, false, motor.brake->torque);
  Y y{0, 0, 0, 0};
  bool stuck = false;
  double time = 0, work = 0, lost = 0, exponential = 0, steady = 0, at_rest = 0;
  // Rigid rope: the drum runs up with one time constant.
  const double inertia = J + m * radius * radius, slope = n * n * stall / free,
               settled = (n * stall - m * g * radius) / slope, tau = inertia / slope;
  SeenRun run(scene);
  Comparison table("winch");
  run.go([&](double t, const State& s) {
    constexpr int steps = 100;
    const double h = (t - time) / steps;
    for (int i = 0; i < steps; ++i) {
      const double now = time + i * h;
      if (now < 1 - 1e-9 || stuck) {
        y = stepped<4>(y, now, h, hold);
      } else if (now < 5 - 1e-9) {
        const double from = lifting(y) * y[2];
        y = stepped<4>(y, now, h, raise);
        work += h / 2 * (from + lifting(y) * y[2]);
      } else {
        Y next = stepped<4>(y, now, h, slow);
        if (next[2] < 0) {
          // The drum comes to rest within this step, and the brake holds it.
          double part = h * y[2] / (y[2] - next[2]);
          for (int j = 0; j < 5; ++j) {
            next = stepped<4>(y, now, part, slow);
            part -= next[2] / slow(now, next)[2];
          }
          lost += motor.brake->torque * (next[0] - y[0]);
          next[2] = 0, stuck = true;
          next = stepped<4>(next, now + part, h - part, hold);
        } else {
          lost += motor.brake->torque * (next[0] - y[0]);
        }
        y = next;
      }
    }
    time = t;
    // The free load comes first: its translation and its rotation.
    const Y seen{s.q[7], s.q[2], s.u[6], s.u[2]};
    table.see("drum [rad]", seen[0], y[0]);
    table.see("load [m]", seen[1], y[1]);
    table.see("rate of the drum [rad/s]", seen[2], y[2]);
    table.see("tension of the rope [N]", tension(seen), tension(y));
    if (std::abs(t - 1 - std::round(tau * 100) / 100) < 1e-6)
      exponential = seen[2] / (settled * (1 - std::exp(-(t - 1) / tau)));
    if (std::abs(t - 5) < 1e-6) steady = seen[2];
    if (std::abs(t - 6.5) < 1e-6) at_rest = seen[0];
    if (t > 6.5) {
      EXPECT_EQ(seen[0], at_rest);
    }
  });
  expect_close("run-up over the exponential after one time constant", exponential, 1, 2e-2);
  expect_close("steady rate where curve and load meet [rad/s]", steady, settled, 1e-3 * settled);
  const auto facts = nlohmann::json::parse(run.solver.report().facts);
  expect_close("work of the motor [J]", facts["mbd_work_J"]["actuators"], work, 1e-3 * work);
  expect_close("lost in the brake, and some in the rope [J]", facts["mbd_dissipated_J"], lost, 1e-2 * lost);
  expect_close("residual of the energy [J]", facts["mbd_energy_balance_J"], 0, 1e-3 * work);
  table.expect_within(2e-3);
}

}  // namespace
}  // namespace tandem::mbd
