// Results over time of elements and driven joints: closed forms, and the sum of their works and losses
// against the energy balance.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/scene/element_columns.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;

// A run that is observed at the end of each window.
class ObservedRun {
 public:
  explicit ObservedRun(const scene::Scene& scene) : scene_(scene), columns_(scene::element_columns(scene)) {
    solver_.configure(scene);
    values_ = solver_.observe().elements;
  }
  // Calls f(time) after each window.
  template <class F>
  void go(F f) {
    const std::int64_t window = to_nanoseconds(scene_.coupling.window).count,
                       end = to_nanoseconds(scene_.end_time).count;
    for (std::int64_t t = 0; t < end; t += window) {
      protocol::LoadSet loads;
      loads.window = {static_cast<std::uint64_t>(t / window), {t}, {std::min(t + window, end)}};
      solver_.advance(loads);
      values_ = solver_.observe().elements;
      ASSERT_EQ(values_.size(), columns_.size());
      f(to_seconds(loads.window.end));
    }
  }
  void go() {
    go([](double) {});
  }
  double operator[](const std::string& column) const {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    EXPECT_NE(found, columns_.end()) << column;
    return found == columns_.end() ? NAN : values_[static_cast<std::size_t>(found - columns_.begin())];
  }
  // Sum of all columns of this channel.
  double sum(const std::string& channel) const {
    double sum = 0;
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (columns_[i].ends_with("." + channel)) sum += values_[i];
    return sum;
  }
  nlohmann::json facts() { return nlohmann::json::parse(solver_.report().facts); }
  MbdSolver& solver() { return solver_; }

 private:
  scene::Scene scene_;
  std::vector<std::string> columns_;
  MbdSolver solver_;
  std::vector<double> values_;
};

scene::Scene flywheel(double inertia) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId body = machines::add_body(scene, "wheel", 1, {1, 1, inertia}, {0, 0, 0});
  machines::add_joint(scene, "axle", JointType::revolute, ground, body, {0, 0, 0});
  return scene;
}

// A line T = 20 - 0.2 w against a damper of 0.3 N m s/rad: 40 rad/s, 12 N m, 480 W.
TEST(ElementResults, MotorAtTheEquilibriumOfItsCurve) {
  scene::Scene scene = flywheel(.05);
  scene.mbd->joints[0].damping = .3;
  scene::Motor motor;
  motor.name = "drive", motor.joint = JointId{0};
  motor.control = scene::MotorControl::throttle, motor.target = scene::ConstantMotion{1, 0};
  motor.torque_speed = scene::ForceTable{{0, 100}, {20, 0}};
  scene.mbd->forces.push_back(motor);
  scene.coupling.window = .01, scene.end_time = 3, scene.mbd->integrator.step = 1e-3;
  ObservedRun run(scene);
  double before = 0;
  run.go([&](double t) {
    EXPECT_EQ(run["drive.power"], run["drive.torque"] * run["drive.speed"]);
    if (t > 2.985) before = t < 2.995 ? run["drive.energy"] : before;
  });
  EXPECT_NEAR(run["drive.torque"], 12, 1e-6);
  EXPECT_NEAR(run["drive.speed"], 40, 1e-6);
  EXPECT_NEAR(run["drive.power"], 480, 1e-4);
  EXPECT_EQ(run["drive.throttle"], 1);
  EXPECT_NEAR(run["axle.loss_power"], 480, 1e-4);
  EXPECT_NEAR(run["drive.energy"] - before, 4.80, 1e-6) << "in one window";
  // Work = kinetic energy + loss.
  const double kinetic = .5 * .05 * run["drive.speed"] * run["drive.speed"];
  EXPECT_NEAR(run["drive.energy"], kinetic + run["axle.loss_energy"], 1e-6 * run["drive.energy"]);
}

TEST(ElementResults, BrakeOfAMotorStopsItsWheel) {
  for (const bool holds : {false, true}) {
    scene::Scene scene = flywheel(.4);
    scene.mbd->joints[0].rate = 10;
    scene::Motor motor;
    motor.name = "drive", motor.joint = JointId{0};
    motor.target = scene::ConstantMotion{0, 0}, motor.gains = {};
    motor.control = scene::MotorControl::throttle;
    motor.torque_speed = scene::ForceTable{{-100, 100}, {0, 0}};
    motor.brake = scene::Brake{2, 1e-3, {}, {}, ""};
    if (holds) motor.brake->breakaway = 3;
    scene.mbd->forces.push_back(motor);
    scene.coupling.window = .01, scene.end_time = 1, scene.mbd->integrator.step = 1e-3;
    ObservedRun run(scene);
    run.go();
    const double rate = 10 - 2 / .4;  // after 1 s
    EXPECT_NEAR(run["drive.brake_torque"], -2, 1e-9);
    EXPECT_NEAR(run["drive.speed"], rate, 1e-9);
    EXPECT_NEAR(run["drive.loss_power"], 2 * rate, 1e-8);
    EXPECT_NEAR(run["drive.loss_energy"], .5 * .4 * (100 - rate * rate), 1e-8);
    EXPECT_EQ(run["drive.torque"], 0);
    EXPECT_EQ(run["drive.energy"], 0);
  }
}

// A brake that holds a wheel at rest has the torque that this takes, and no loss.
TEST(ElementResults, BrakeOfAMotorHoldsItsWheel) {
  scene::Scene scene = flywheel(.4);
  scene::Motor motor;
  motor.name = "drive", motor.joint = JointId{0};
  motor.target = scene::ConstantMotion{0, 0};
  motor.control = scene::MotorControl::throttle;
  motor.torque_speed = scene::ForceTable{{-100, 100}, {0, 0}};
  motor.brake = scene::Brake{2, 0, 3, {}, ""};
  scene.mbd->forces.push_back(motor);
  scene.mbd->forces.push_back(scene::Actuator{"load", JointId{0}, scene::ConstantMotion{1.5, 0}});
  scene.coupling.window = .01, scene.end_time = .1, scene.mbd->integrator.step = 1e-3;
  ObservedRun run(scene);
  run.go();
  EXPECT_NEAR(run["drive.brake_torque"], -1.5, 1e-12);
  EXPECT_EQ(run["drive.speed"], 0);
  EXPECT_EQ(run["drive.loss_energy"], 0);
  EXPECT_EQ(run["drive.torque"], 0);
}

// A mass that a cylinder lifts against gravity, with friction in its seals: what it gives is kinetic and
// potential energy, and the integral of force times rate.
TEST(ElementResults, CylinderLiftsAMass) {
  const double m = 200, g = 9.81, h = 1e-3, a = 300 / m, t = 1;
  scene::Scene scene = machines::empty({0, 0, -g});
  const BodyId body = machines::add_body(scene, "mass", m, {1, 1, 1}, {0, 0, 1});
  machines::add_joint(scene, "guide", JointType::prismatic, ground, body, {0, 0, 1}, {0, 0, 1}).rate = 1;
  scene::Cylinder c;
  c.name = "lift", c.body_b = body, c.point_b = {0, 0, 1};
  c.target = scene::ConstantMotion{m * g + 400, 0};
  c.friction = scene::Friction{100, 1e-3};
  scene.mbd->forces.push_back(c);
  scene.coupling.window = h, scene.end_time = t, scene.mbd->integrator.step = h;
  ObservedRun run(scene);
  double integral = 0, power = m * g + 300;  // at the start
  run.go([&](double) {
    integral += h / 2 * (power + run["lift.power"]);
    power = run["lift.power"];
  });
  const double z = t + a / 2 * t * t, v = 1 + a * t, exact = .5 * m * (v * v - 1) + m * g * z;
  EXPECT_NEAR(run["lift.force"], m * g + 300, 1e-9 * m * g);
  EXPECT_NEAR(run["lift.stroke"], z, 1e-9);
  EXPECT_NEAR(run["lift.velocity"], v, 1e-9);
  EXPECT_NEAR(run["lift.power"], (m * g + 300) * v, 1e-6);
  EXPECT_NEAR(run["lift.energy"], exact, 1e-9 * exact);
  EXPECT_NEAR(run["lift.loss_energy"], 100 * z, 1e-9 * 100 * z);
  EXPECT_NEAR(run["lift.loss_power"], 100 * v, 1e-9 * 100 * v);
  EXPECT_NEAR(integral, run["lift.energy"], 1e-9 * exact);
}

TEST(ElementResults, AHangingRopeCarriesTheWeight) {
  scene::Scene scene = machines::empty({0, 0, -10});
  const BodyId body = machines::add_body(scene, "load", 50, {1, 1, 1}, {0, 0, -2});
  machines::add_joint(scene, "guide", JointType::prismatic, ground, body, {0, 0, -2}, {0, 0, 1});
  scene::Rope rope;
  rope.name = "rope";
  rope.points = {{ground, {0, 0, 0}}, {body, {0, 0, -2}}};
  rope.length = 2.05, rope.axial_stiffness = 2.05e5, rope.damping = 2;
  scene.mbd->forces.push_back(rope);
  scene.coupling.window = 1e-3, scene.end_time = 4, scene.mbd->integrator.step = 2e-4;
  ObservedRun run(scene);
  bool first = true;
  run.go([&](double) {
    if (std::exchange(first, false)) {
      EXPECT_NEAR(run["rope.slack"], .05, 1e-4);
      EXPECT_EQ(run["rope.tension"], 0);
    }
  });
  EXPECT_NEAR(run["rope.tension"], 500, .1);
  EXPECT_EQ(run["rope.slack"], 0);
  EXPECT_NEAR(run["rope.length"], 2.05 + 500 / 1e5, 1e-5);
  EXPECT_NEAR(run["rope.stored_energy"], .5 * 500 * 500 / 1e5, 1e-3);
  EXPECT_NEAR(run["rope.loss_energy"], 50 * 10 * .055 - run["rope.stored_energy"], .2);
}

// A prescribed speed drives a second wheel through a gear of ratio -2 against a torque.
TEST(ElementResults, AGearTransmitsThePowerOfAPrescribedMotion) {
  scene::Scene scene = flywheel(.4);
  const BodyId second = machines::add_body(scene, "second", 1, {.2, .2, .2}, {1, 0, 0});
  machines::add_joint(scene, "out", JointType::revolute, ground, second, {1, 0, 0});
  scene.mbd->joints[0].motion = scene::ConstantMotion{0, 3};
  scene.mbd->couplers.push_back({"gear", scene::CouplerType::gear, JointId{0}, JointId{1}, -2});
  scene.mbd->forces.push_back(scene::Actuator{"load", JointId{1}, scene::ConstantMotion{5, 0}});
  scene.coupling.window = .01, scene.end_time = .5;
  ObservedRun run(scene);
  run.go();
  EXPECT_NEAR(run["gear.torque.out"], -5, 1e-12);
  EXPECT_NEAR(run["gear.torque.axle"], -10, 1e-12);
  EXPECT_NEAR(run["gear.power"], 30, 1e-12);
  EXPECT_NEAR(run["axle.torque"], 10, 1e-12);
  EXPECT_EQ(run["axle.speed"], 3);
  EXPECT_NEAR(run["axle.power"], 30, 1e-12);
  EXPECT_NEAR(run["axle.energy"], 15, 1e-10);
  EXPECT_NEAR(run["load.power"], -30, 1e-12);
  EXPECT_NEAR(run["load.energy"], -15, 1e-10);
}

// All kinds at once: nothing of the balance is without an element, and nothing is counted twice.
scene::Scene of_all_kinds() {
  scene::Scene scene = machines::empty({0, 0, -9.81});
  const BodyId a = machines::add_body(scene, "a", 2, {.2, .2, .2}, {0, 0, 0});
  const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {1, 0, 0});
  const BodyId c = machines::add_body(scene, "c", 3, {.1, .1, .1}, {0, 2, 0});
  const BodyId d = machines::add_body(scene, "d", 1, {.1, .2, .3}, {3, 0, 0});
  machines::add_joint(scene, "base", JointType::revolute, ground, a, {0, 0, 0}, {0, 1, 0});
  machines::add_joint(scene, "elbow", JointType::revolute, a, b, {.5, 0, 0}, {0, 1, 0});
  machines::add_joint(scene, "rail", JointType::prismatic, ground, c, {0, 2, 0}, {0, 0, 1});
  scene::Mbd& mbd = *scene.mbd;
  mbd.joints[0].motion = scene::HarmonicMotion{0, .3, 1, 0};
  mbd.joints[0].damping = .7;
  mbd.joints[1].friction = scene::Friction{.3, 1e-2};
  mbd.joints[1].limits = scene::Limits{-.2, .2, 2e3, 0, .6};
  mbd.joints[2].damping = 5;
  mbd.forces.push_back(scene::SpringDamper{"spring", ground, b, {1, 0, 1}, {1, 0, 0}, 200, 3, 1});
  mbd.forces.push_back(scene::RotationalSpringDamper{"coil", JointId{1}, 5, .05, 0});
  scene::Bushing bushing{"mount", ground, d, {3, 0, .1}, {}, {}};
  for (int i = 0; i < 6; ++i) bushing.stiffness[7 * i] = 900, bushing.damping[7 * i] = 4;
  mbd.forces.push_back(bushing);
  mbd.forces.push_back(scene::BodyLoad{"push",
                                       scene::BodyLoad::Kind::force,
                                       d,
                                       {3, .1, 0},
                                       {0, 1, 0},
                                       true,
                                       scene::HarmonicMotion{0, 3, 2, 0}});
  mbd.forces.push_back(scene::BodyLoad{
      "twist", scene::BodyLoad::Kind::torque, d, {}, {1, 0, 0}, false, scene::ConstantMotion{.2, 0}});
  mbd.forces.push_back(scene::Actuator{"act", JointId{1}, scene::HarmonicMotion{0, 1, 3, 0}});
  scene::Rope rope;
  rope.name = "rope", rope.points = {{ground, {0, 2, 1}}, {c, {0, 2, 0}}};
  rope.length = .99, rope.axial_stiffness = 3e3, rope.damping = .01;
  mbd.forces.push_back(rope);
  scene::Motor motor;
  motor.name = "motor", motor.joint = JointId{1}, motor.control = scene::MotorControl::speed;
  motor.target = scene::ConstantMotion{.5, 0}, motor.gains.proportional = .2, motor.gains.integral = .5;
  motor.brake = scene::Brake{.1, 1e-2, {}, {}, ""};
  mbd.forces.push_back(motor);
  scene::Cylinder jack;
  jack.name = "jack", jack.body_b = c, jack.point_a = {0, 2, -1}, jack.point_b = {0, 2, 0};
  jack.control = scene::CylinderControl::valve, jack.target = scene::HarmonicMotion{0, .3, 1, 0};
  jack.hydraulics.emplace();
  jack.hydraulics->bore_area = 2e-4, jack.hydraulics->rod_area = 8e-5, jack.hydraulics->dead_volume = 1e-5;
  jack.hydraulics->supply_pressure = 3e6, jack.hydraulics->valve_flow = 5e-5,
  jack.hydraulics->leakage = 1e-12;
  jack.limits = scene::Limits{-.3, .3, 1e6, 0};
  mbd.forces.push_back(jack);
  scene::Cylinder strut;
  strut.name = "strut", strut.body_b = c, strut.point_a = {0, 2, -2}, strut.point_b = {0, 2, 0};
  strut.control = scene::CylinderControl::stroke, strut.target = scene::ConstantMotion{.01, 0};
  strut.gains.proportional = 300, strut.damping = 4, strut.limits = scene::Limits{-.5, .5, 1e5, 1};
  mbd.forces.push_back(strut);
  scene.coupling.window = .01, scene.end_time = 1, mbd.integrator.step = 1e-3;
  return scene;
}

TEST(ElementResults, TheirSumsAreTheEnergyBalance) {
  ObservedRun run(of_all_kinds());
  run.go();
  const nlohmann::json facts = run.facts();
  const double lost = facts["mbd_dissipated_J"], loads = facts["mbd_work_J"]["loads"],
               motions = facts["mbd_work_J"]["motions"], actuators = facts["mbd_work_J"]["actuators"];
  EXPECT_GT(facts["mbd_stop_contacts"].get<int>(), 0);
  EXPECT_NEAR(run.sum("loss_energy"), lost, 1e-12 * lost);
  EXPECT_NEAR(run["push.energy"] + run["twist.energy"], loads, 1e-12 * std::abs(loads));
  EXPECT_NEAR(run["base.energy"], motions, 1e-12 * std::abs(motions));
  // A cylinder gives the machine what comes in, less what it dissipates and stores.
  const double strut = run["strut.energy"] + run["strut.loss_energy"] + run["strut.stored_energy"];
  EXPECT_NEAR(run["act.energy"] + run["motor.energy"] + run["jack.supply_energy"] + strut, actuators,
              1e-11 * std::abs(actuators));
  for (const char* column :
       {"spring", "coil", "mount", "rope", "motor", "jack", "strut", "base", "elbow", "rail"})
    EXPECT_GT(std::abs(run[std::string(column) + ".loss_energy"]), 0) << column;
}

// The integral of each power is the energy of its element, to the order of the method.
TEST(ElementResults, EachPowerIntegratesToItsEnergy) {
  scene::Scene scene = of_all_kinds();
  // Contacts begin and end within windows.
  scene.mbd->joints[1].limits.reset();
  std::map<std::string, double> errors;
  for (const double h : {1e-3, 5e-4}) {
    scene.coupling.window = scene.mbd->integrator.step.emplace(h);
    ObservedRun run(scene);
    const std::vector<std::string> names = scene::element_columns(scene);
    std::map<std::string, double> integral, power;
    for (const std::string& name : names) power[name] = run[name];
    run.go([&](double) {
      for (const std::string& name : names) {
        if (!name.ends_with("power")) continue;
        integral[name] += h / 2 * (power[name] + run[name]);
        power[name] = run[name];
      }
    });
    for (const auto& [name, value] : integral) {
      const std::string energy = name.substr(0, name.size() - 5) + "energy";
      if (std::find(names.begin(), names.end(), energy) == names.end()) continue;
      const double error = std::abs(value - run[energy]);
      std::printf("h = %.0e s: %-18s %12.6f J, integral of the power %12.6f J\n", h, energy.c_str(),
                  run[energy], value);
      EXPECT_LT(error, 1e-3 * std::abs(run[energy]) + 2e-5) << energy;
      // Friction and brake reverse within a step.
      const bool smooth = energy != "elbow.loss_energy" && energy != "motor.loss_energy";
      if (smooth && h < 1e-3 && errors[energy] > 1e-6) {
        EXPECT_GT(errors[energy] / error, 3.3) << energy << " is of second order";
      }
      errors[energy] = error;
    }
  }
}

TEST(ElementResults, AreTheSameAfterARestart) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("element_results_" + std::to_string(getpid()) + ".h5");
  const scene::Scene scene = of_all_kinds();
  MbdSolver whole, second;
  const auto advance = [](MbdSolver& solver, int first, int last) {
    for (int n = first; n < last; ++n) {
      protocol::LoadSet loads;
      loads.window = {static_cast<std::uint64_t>(n), {n * 10'000'000ll}, {(n + 1) * 10'000'000ll}};
      solver.advance(loads);
    }
  };
  whole.configure(scene);
  advance(whole, 0, 40);
  whole.checkpoint({40, {400'000'000}, path.string()});
  advance(whole, 40, 60);
  second.configure(scene);
  second.resume({40, {400'000'000}, path.string()});
  advance(second, 40, 60);
  std::filesystem::remove(path);
  EXPECT_EQ(whole.observe().elements, second.observe().elements);
}

TEST(ElementResults, GoBackWithARollback) {
  ObservedRun run(of_all_kinds());
  MbdSolver& solver = run.solver();
  const auto window = [&](int n) {
    protocol::LoadSet loads;
    loads.window = {static_cast<std::uint64_t>(n), {n * 10'000'000ll}, {(n + 1) * 10'000'000ll}};
    solver.advance(loads);
    return solver.observe().elements;
  };
  window(0);
  solver.save();
  const std::vector<double> first = window(1);
  solver.restore();
  EXPECT_EQ(window(1), first);
}

TEST(ElementResults, AMachineWithoutElementsHasNone) {
  MbdSolver solver;
  solver.configure(machines::pendulum());
  EXPECT_TRUE(solver.observe().elements.empty());
}

}  // namespace
}  // namespace tandem::mbd
