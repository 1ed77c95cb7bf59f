// Contacts with stops through the solver: machines, initial states and windows that a treatment of a single
// falling body would not cover.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/setup/build.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;
using scene::Limits;

// A solver that is advanced in windows of equal length.
struct Windows {
  MbdSolver solver;
  double length;
  std::uint64_t n = 0;

  explicit Windows(const scene::Scene& scene) : length(scene.coupling.window) { solver.configure(scene); }
  void advance() {
    const auto H = static_cast<std::int64_t>(std::llround(length * 1e9));
    protocol::LoadSet none;
    none.window = {n, {static_cast<std::int64_t>(n) * H}, {static_cast<std::int64_t>(n + 1) * H}};
    ++n;
    solver.advance(none);
  }
  const State& until(double end) {
    while (static_cast<double>(n) * length < end - 1e-9) advance();
    return solver.state();
  }
  double energy() { return solver.observe().energy; }
  double fact(const std::string& key) {
    return nlohmann::json::parse(solver.report().facts).at(key).get<double>();
  }
};

void fixed(scene::Scene& scene, double step, double window = .01) {
  scene.coupling.window = window;
  scene.mbd->integrator.step = step;
}
void controlled(scene::Scene& scene, double tolerance, double window = .01) {
  scene.coupling.window = window;
  scene.mbd->integrator.error_tolerance = tolerance;
}

scene::Scene lift(const Limits& limits, double mass = 1) {
  scene::Scene scene = machines::empty();
  const BodyId body = machines::add_body(scene, "b", mass, {.1, .1, .1}, {0, 0, 0});
  machines::add_joint(scene, "j", JointType::prismatic, ground, body, {0, 0, 0}).limits = limits;
  return scene;
}

// (1 + e) x = ln((1 + x) / (1 - e x))
TEST(StopContacts, DampingNumberMeetsItsEquation) {
  EXPECT_EQ(damping_number(1), 0);
  for (const double e : {.999, .9, .5, .2, .05}) {
    const double x = damping_number(e);
    EXPECT_GT(x, 0);
    EXPECT_NEAR((1 + e) * x, std::log((1 + x) / (1 - e * x)), 1e-9 * x) << e;
  }
  EXPECT_NEAR(damping_number(.01), 100, 1e-9);
  // To first order in the loss.
  EXPECT_NEAR(damping_number(.999), 1.5e-3, 1e-5);
}

// A sequence of ever shorter bounces ends, and a body at rest does not need steps for the vibration of its
// stop.
TEST(StopContacts, ABodyComesToRest) {
  for (const double k : {1e4, 1e6, 1e9, 1e12})
    for (const double e : {.2, .5, .9})
      for (const bool control : {false, true}) {
        scene::Scene scene = lift({.lower = -.1, .upper = 100, .stiffness = k, .restitution = e});
        control ? controlled(scene, 1e-8) : fixed(scene, 1e-2);
        Windows run(scene);
        const double start = run.energy();
        double highest = start;
        for (int i = 0; i < 1000; ++i) run.advance(), highest = std::max(highest, run.energy());
        EXPECT_LE(highest, start + 1e-9) << k << " " << e << " " << control;
        EXPECT_NEAR(run.solver.state().q[0], -.1 - 9.81 / k, 1e-9 + 1e-3 * 9.81 / k)
            << k << " " << e << " " << control;
        const double steps = run.fact("mbd_steps");
        run.until(100);
        EXPECT_NEAR(run.solver.state().q[0], -.1 - 9.81 / k, 2e-11 + 1e-6 * 9.81 / k) << k << " " << e;
        std::printf(
            "%.0e N/m, e = %.1f, %s: %.0f contacts, %.0f settled, %.0f steps in 10 s, %.0f in the next 90 "
            "s\n",
            k, e, control ? "controlled" : "step 0.01 s", run.fact("mbd_stop_contacts"),
            run.fact("mbd_stop_contacts_settled"), steps, run.fact("mbd_steps") - steps);
      }
}

// At rest at its limit, without damping: it sinks in by its static depth.
TEST(StopContacts, ABodyMayStartAtItsLimit) {
  for (const double rho : {.9, 1.})
    for (const double k : {1e6, 1e9, 1e12})
      for (const bool control : {false, true}) {
        scene::Scene scene = lift({.lower = 0, .upper = 1, .stiffness = k});
        scene.mbd->integrator.rho_inf = rho;
        control ? controlled(scene, 1e-6) : fixed(scene, 1e-2);
        Windows run(scene);
        run.until(10);
        EXPECT_NEAR(run.solver.state().q[0], 0, 2.01 * 9.81 / k);
        EXPECT_LE(run.energy(), 1e-7);
        std::printf("%.0e N/m, %s: %.0f contacts, %.0f steps in 10 s\n", k,
                    control ? "controlled" : "step 0.01 s", run.fact("mbd_stop_contacts"),
                    run.fact("mbd_steps"));
      }
}

// A stop that is compressed at the start returns exactly the energy of its spring.
TEST(StopContacts, AStartBeyondALimitIsPushedBack) {
  for (const double e : {1., .5})
    for (const bool control : {false, true}) {
      scene::Scene scene = machines::empty({0, 0, 0});
      const BodyId body = machines::add_body(scene, "b", 2, {.1, .1, .1}, {0, 0, 0});
      machines::add_joint(scene, "j", JointType::prismatic, ground, body, {0, 0, 0}).limits =
          Limits{.lower = -1, .upper = -.01, .stiffness = 1e8, .restitution = e};
      control ? controlled(scene, 1e-8) : fixed(scene, 1e-3);
      Windows run(scene);
      const State& s = run.until(.01);
      const double stored = .5 * 1e8 * 1e-4, kinetic = s.u[0] * s.u[0];
      if (e == 1) {
        EXPECT_NEAR(kinetic, stored, 1e-4 * stored);
      }
      EXPECT_LE(kinetic, stored * (1 + 1e-9));
      EXPECT_LT(s.u[0], 0);
    }
}

// The gap between the limits is a billionth of a metre.
TEST(StopContacts, LimitsWithHardlyAnyPlayHold) {
  for (const double e : {1., .3})
    for (const bool control : {false, true}) {
      scene::Scene scene = lift({.lower = -1e-9, .upper = 1e-9, .stiffness = 1e10, .restitution = e});
      scene.mbd->joints[0].rate = 1;
      control ? controlled(scene, 1e-6) : fixed(scene, 1e-3);
      Windows run(scene);
      for (int i = 0; i < 20; ++i) {
        run.advance();
        EXPECT_LE(run.energy(), .5 * (1 + 1e-4));
        EXPECT_LE(std::abs(run.solver.state().q[0]), 1.01e-5);
      }
      std::printf("play of 2 nm, e = %.1f: %.0f contacts, %.0f steps in 0.2 s, %.2e J of 0.5 J\n", e,
                  run.fact("mbd_stop_contacts"), run.fact("mbd_steps"), run.energy());
    }
}

// Three equal beads in a row; the relative coordinates between them have stops. The first bead transfers all
// of its speed to the last where gaps separate the contacts in time.
TEST(StopContacts, ACradleOfThreePassesTheSpeedOn) {
  for (const double k : {1e5, 1e8, 1e12})
    for (const bool control : {false, true}) {
      scene::Scene scene = machines::empty({0, 0, 0});
      BodyId last = ground;
      for (int i = 0; i < 3; ++i) {
        const BodyId bead =
            machines::add_body(scene, "b" + std::to_string(i), 1, {.1, .1, .1}, {0, 0, .1 * i});
        scene::Joint& joint = machines::add_joint(scene, "j" + std::to_string(i), JointType::prismatic, last,
                                                  bead, {0, 0, .1 * i});
        if (i > 0) joint.limits = Limits{.lower = -.01 * i, .upper = 10, .stiffness = k};
        joint.rate = i == 0 ? 1 : i == 1 ? -1 : 0;  // the first moves, the others rest
        last = bead;
      }
      control ? controlled(scene, 1e-8) : fixed(scene, 1e-2);
      Windows run(scene);
      const State& s = run.until(.5);
      const double v0 = s.u[0], v1 = v0 + s.u[1], v2 = v1 + s.u[2];
      std::printf("%.0e N/m, %s: speeds %.2e %.2e %.9f\n", k, control ? "controlled" : "step 0.01 s", v0, v1,
                  v2);
      EXPECT_NEAR(v2, 1, 1e-4);
      EXPECT_NEAR(v0, 0, 1e-4);
      EXPECT_LE(run.energy(), .5 * (1 + 1e-9));
      EXPECT_NEAR(v0 + v1 + v2, 1, 1e-9);
    }
}

// A pendulum of two rods whose knee and hip have stops, and one in a closed loop: no energy is created,
// little is lost.
TEST(StopContacts, ChainsAndLoopsKeepTheirEnergy) {
  for (const double k : {1e4, 1e7, 1e10})
    for (const int machine : {0, 1, 2})
      for (const bool control : {false, true}) {
        scene::Scene scene;
        if (machine == 0) {
          scene = machines::chain(3);
          for (scene::Joint& j : scene.mbd->joints)
            j.limits = Limits{.lower = -.4, .upper = .5, .stiffness = k};
        } else {
          scene = machines::ladder(1);
          // The cut is elsewhere: joints with limits stay in the tree.
          scene.mbd->joints[0].limits = Limits{.lower = -.6, .upper = .3, .stiffness = k};
          if (machine == 2) scene.mbd->joints[1].limits = scene.mbd->joints[0].limits;
        }
        control ? controlled(scene, 1e-8) : fixed(scene, 1e-3);
        Windows run(scene);
        const double start = run.energy();
        double highest = start, lowest = start;
        while (run.n < 100)
          run.advance(), highest = std::max(highest, run.energy()), lowest = std::min(lowest, run.energy());
        std::printf("machine %d, %.0e N m/rad, %s: energy %+.2e .. %+.2e J; %.0f contacts, %.0f steps\n",
                    machine, k, control ? "controlled" : "step 1e-3 s", lowest - start, highest - start,
                    run.fact("mbd_stop_contacts"), run.fact("mbd_steps"));
        const double scale = machine == 0 ? .1 * 9.81 * .3 : 9.81;
        EXPECT_LE(highest - start, 2e-3 * scale);
        EXPECT_GE(lowest - start, -2e-2 * scale);
        EXPECT_GT(run.fact("mbd_stop_contacts"), 0);
      }
}

// The child is nearer to the ground: the coordinate is that of the reversed joint.
TEST(StopContacts, AReversedJointHasItsLimitsWhereTheSceneSays) {
  for (const bool control : {false, true}) {
    scene::Scene scene = machines::empty();
    const BodyId a = machines::add_body(scene, "a", 1, {.1, .1, .1}, {0, 0, 0});
    const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {0, 0, -1});
    machines::add_joint(scene, "hold", JointType::fixed, ground, a, {0, 0, 0});
    // b falls away from a, its child: the coordinate, a seen from b, grows.
    machines::add_joint(scene, "j", JointType::prismatic, b, a, {0, 0, 0}).limits =
        Limits{.lower = -5, .upper = .1, .stiffness = 1e9, .restitution = .5};
    control ? controlled(scene, 1e-8) : fixed(scene, 1e-2);
    Windows run(scene);
    const State& s = run.until(.2);
    const double rise = s.u[0] * s.u[0] / (2 * 9.81) + (.1 - std::abs(s.q[0]));
    EXPECT_NEAR(rise, .025, .01 * .025) << s.q[0] << " " << s.u[0];
  }
}

// A crank presses a body against its stop through a spring: the driven neighbour does not disturb the
// contact.
TEST(StopContacts, ADrivenNeighbourPressesABodyAgainstItsStop) {
  for (const bool control : {false, true}) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId driver = machines::add_body(scene, "driver", 1, {.1, .1, .1}, {0, 0, 0});
    const BodyId body = machines::add_body(scene, "body", 1, {.1, .1, .1}, {.5, 0, 0});
    machines::add_joint(scene, "drive", JointType::prismatic, ground, driver, {0, 0, 0}, {1, 0, 0}).motion =
        scene::HarmonicMotion{0, .1, 1, 0};
    machines::add_joint(scene, "slide", JointType::prismatic, ground, body, {.5, 0, 0}, {1, 0, 0}).limits =
        Limits{.lower = -1, .upper = .02, .stiffness = 1e9, .restitution = .5};
    scene.mbd->forces.push_back(scene::SpringDamper{"s", driver, body, {0, 0, 0}, {.5, 0, 0}, 500, 5, .5});
    control ? controlled(scene, 1e-7) : fixed(scene, 1e-3);
    Windows run(scene);
    // At 0.25 s the drive is at its end: the body rests against the stop with the force of the spring.
    const State& s = run.until(.25);
    EXPECT_NEAR(s.q[0] - .02, 500 * .08 / 1e9, 2e-9);
    // At 0.75 s it is moved away from the stop.
    EXPECT_LT(run.until(.75).q[0], 0);
  }
}

// Friction on the coordinate of a stop dissipates energy and never creates any.
TEST(StopContacts, FrictionAndStopsTogether) {
  for (const double k : {1e6, 1e10})
    for (const bool control : {false, true}) {
      scene::Scene scene = machines::bead(1, 2);
      scene.mbd->joints[0].limits = Limits{.lower = -.05, .upper = .05, .stiffness = k};
      scene.mbd->joints[0].friction = scene::Friction{1, 1e-3};
      control ? controlled(scene, 1e-8) : fixed(scene, 1e-3);
      Windows run(scene);
      // The stopping distance under 1 N is 2 m; the stops are 0.1 m apart.
      double last = run.energy();
      for (int i = 0; i < 250; ++i) {
        run.advance();
        EXPECT_LE(run.energy(), last + 1e-8);
        last = run.energy();
      }
      EXPECT_NEAR(std::abs(run.solver.state().u[0]), 0, 1e-2);
      Windows half(scene);
      half.until(1);
      EXPECT_NEAR(half.energy(), .5, k == 1e6 ? .02 : .002);  // (2 - t)^2 / 2, but for the time in the stops
    }
}

// A body in contact with its stop gives the same bits after a restore, and after reading its state from a
// file.
TEST(StopContacts, RestoredStatesGiveTheSameBits) {
  for (const double window : {1e-3, 7e-4})
    for (const bool control : {false, true}) {
      scene::Scene scene = lift({.lower = -.01, .upper = 1, .stiffness = 1e5, .restitution = .7});
      machines::add_joint(scene, "swing", JointType::revolute, BodyId{0},
                          machines::add_body(scene, "arm", 1, {.1, .1, .1}, {.3, 0, 0}), {0, 0, 0}, {0, 1, 0})
          .limits = Limits{.lower = -.3, .upper = .3, .stiffness = 1e8};
      control ? controlled(scene, 1e-7, window) : fixed(scene, window / 2, window);
      Windows straight(scene), again(scene), resumed(scene);
      const auto file = std::filesystem::temp_directory_path() / "tandem_stop_contacts.h5";
      bool within = false;
      for (int i = 0; i < 200; ++i) {
        straight.advance();
        again.solver.save();
        again.advance();
        again.solver.restore();
        --again.n;
        again.advance();
        EXPECT_EQ(hash(straight.solver.state()), hash(again.solver.state())) << i;
        EXPECT_EQ(to_nanoseconds(straight.solver.state().time).count,
                  std::llround(i * window * 1e9 + window * 1e9));
        if (!within && straight.solver.state().stops(StopRow::entry_rate, 0) != 0) {
          within = true;
          const Nanoseconds time = to_nanoseconds(straight.solver.state().time);
          straight.solver.checkpoint({straight.n, time, file.string()});
          resumed.solver.resume({straight.n, time, file.string()});
          resumed.n = straight.n;
          for (int k = 0; k < 20; ++k) resumed.advance();
          for (int k = 0; k < 20; ++k) straight.advance(), again.advance(), ++i;
          EXPECT_EQ(hash(straight.solver.state()), hash(resumed.solver.state()));
        }
      }
      EXPECT_TRUE(within);
      std::filesystem::remove(file);
    }
}

}  // namespace
}  // namespace tandem::mbd
