// The solver as the coordinator uses it: windows, predictions, recorded impulse and work, save and restore.
#include "mbd_server/coupling/mbd_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using protocol::BodyMotion;
using protocol::LoadSet;
using protocol::MotionSet;

constexpr std::int64_t window_length = 1'000'000;  // [ns]

Window window(std::uint64_t n) {
  const auto begin = static_cast<std::int64_t>(n) * window_length;
  return {n, {begin}, {begin + window_length}};
}

LoadSet loads(std::uint64_t n, const std::vector<std::uint32_t>& bodies) {
  LoadSet set;
  set.window = window(n);
  for (const std::uint32_t b : bodies) {
    protocol::BodyLoad load;
    load.body = b;
    const double s = static_cast<double>(n + b);
    load.mean = {{10 * std::sin(s), -7 * std::cos(2 * s), 12}, {.3 * std::cos(s), .1, -.2 * std::sin(3 * s)}};
    set.bodies.push_back(load);
  }
  return set;
}

const std::vector<std::uint32_t> walls{3, 5};

TEST(MbdSolver, DescribesWhatItBuilt) {
  MbdSolver solver;
  const protocol::Configured configured = solver.configure(machines::menagerie());
  const auto facts = nlohmann::json::parse(configured.facts);
  EXPECT_EQ(facts["bodies"], 8);
  EXPECT_EQ(facts["dof"], 13);
  EXPECT_EQ(facts["boundary_bodies"], (std::vector<std::string>{"tip", "loose"}));
  EXPECT_EQ(facts["left_out"],
            (std::vector<std::string>{"no closed loops: no multipliers",
                                      "1 bodies welded to another or to the ground: merged"}));
  ASSERT_EQ(configured.boundary.size(), 2u);
  EXPECT_EQ(configured.boundary[1].body, 5u);
  EXPECT_EQ(configured.boundary[1].begin_pose.p_WB, configured.boundary[1].end_pose.p_WB);
  EXPECT_LT(norm(configured.boundary[1].begin_twist.v_WB - Vec3d{.3, -.4, .2}), 1e-15);
}

TEST(MbdSolver, CutsAWindowIntoWholeSteps) {
  for (const auto& [step, steps] :
       std::vector<std::pair<double, int>>{{1e-3, 1}, {4e-4, 3}, {2.5e-4, 4}, {1, 1}}) {
    scene::Scene scene = machines::menagerie();
    scene.mbd->integrator.step = step;
    MbdSolver solver;
    solver.configure(scene);
    solver.advance(loads(0, walls));
    EXPECT_EQ(solver.state().steps, static_cast<std::uint64_t>(steps));
    EXPECT_EQ(solver.state().time, 1e-3);
  }
}

TEST(MbdSolver, PredictsWithHeldRatesAndLeavesTheStateAlone) {
  MbdSolver solver;
  solver.configure(machines::menagerie());
  for (std::uint64_t n = 0; n < 5; ++n) solver.advance(loads(n, walls));
  const std::string before = hash(solver.state());
  const MotionSet& motion = solver.predict(window(5));
  EXPECT_EQ(hash(solver.state()), before);
  // Body "loose" is welded to "cap": its centre of mass moves about the common one, which has constant
  // velocity.
  const BodyMotion& loose = motion.bodies[1];
  EXPECT_LT(norm(loose.end_twist.w_WB - loose.begin_twist.w_WB), 1e-14);
  EXPECT_EQ(loose.applied_work, 0);
  // The path agrees with its velocity to second order, and with its acceleration to third.
  for (const BodyMotion& b : motion.bodies) {
    const Vec3d mean = 1e3 * (b.end_pose.p_WB - b.begin_pose.p_WB);
    const Vec3d hermite = .5 * (b.begin_twist.v_WB + b.end_twist.v_WB) + 1e-3 / 12 * (b.begin_a - b.end_a);
    EXPECT_LT(norm(mean - hermite), 1e-7 * norm(mean));
  }
}

TEST(MbdSolver, PredictsDrivenBodiesExactly) {
  scene::Scene scene = machines::empty();
  const BodyId body = machines::add_body(scene, "piston", 1, {1, 1, 1}, {0, 0, 0});
  machines::add_joint(scene, "drive", scene::JointType::prismatic, ground, body, {0, 0, 0}, {1, 0, 0})
      .motion = scene::HarmonicMotion{0, .1, 5, 0};
  machines::add_wall(scene, body);
  MbdSolver solver;
  solver.configure(scene);
  const double w = 10 * std::numbers::pi;
  const BodyMotion predicted = solver.predict(window(0)).bodies[0];
  EXPECT_NEAR(predicted.end_pose.p_WB.x, .1 * std::sin(w * 1e-3), 1e-16);
  EXPECT_NEAR(predicted.end_twist.v_WB.x, .1 * w * std::cos(w * 1e-3), 1e-14);
  EXPECT_NEAR(predicted.end_a.x, -.1 * w * w * std::sin(w * 1e-3), 1e-13);
  const BodyMotion taken = solver.advance(loads(0, {0})).bodies[0];
  EXPECT_EQ(taken.end_pose.p_WB, predicted.end_pose.p_WB);
}

TEST(MbdSolver, RecordsTheImpulseThatItApplied) {
  scene::Scene scene = machines::menagerie();
  scene.mbd->integrator.step = 1e-3 / 7;
  MbdSolver solver;
  solver.configure(scene);
  for (std::uint64_t n = 0; n < 50; ++n) {
    const LoadSet set = loads(n, walls);
    const MotionSet& motion = solver.advance(set);
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const Wrench& mean = set.bodies[k].mean;
      const Wrench& recorded = motion.bodies[k].applied_impulse;
      EXPECT_LT(norm(recorded.force - 1e-3 * mean.force), 1e-15 * norm(mean.force));
      EXPECT_LT(norm(recorded.torque - 1e-3 * mean.torque), 1e-15 * norm(mean.torque));
    }
  }
}

TEST(MbdSolver, FreeBodyGainsTheBookedImpulse) {
  scene::Scene scene = machines::free_body(2.5, {.1, .2, .3}, {0, 0, 0});
  machines::add_wall(scene, BodyId{0});
  MbdSolver solver;
  solver.configure(scene);
  Vec3d recorded{}, v{};
  for (std::uint64_t n = 0; n < 500; ++n) {
    const BodyMotion& motion = solver.advance(loads(n, {0})).bodies[0];
    recorded += motion.applied_impulse.force;
    v = motion.end_twist.v_WB;
  }
  std::printf(
      "free body, 500 windows: recorded %.15g N s, gained %.15g N s, relative difference %.1e, tolerance "
      "1e-12\n",
      norm(recorded), norm(2.5 * v), norm(2.5 * v - recorded) / norm(recorded));
  EXPECT_LT(norm(2.5 * v - recorded), 1e-12 * norm(recorded));
}

TEST(MbdSolver, WorkOfTheLoadIsTheGainOfEnergy) {
  scene::Scene scene = machines::free_body(2.5, {.1, .2, .3}, {0, 0, -9.81});
  machines::add_wall(scene, BodyId{0});
  MbdSolver solver;
  solver.configure(scene);
  const double start = solver.observe().energy;
  double work = 0;
  for (std::uint64_t n = 0; n < 500; ++n) work += solver.advance(loads(n, {0})).bodies[0].applied_work;
  // Second order in the window, because of the rotation.
  EXPECT_NEAR(solver.observe().energy - start, work, 1e-5 * std::abs(work));
  const auto facts = nlohmann::json::parse(solver.report().facts);
  EXPECT_NEAR(facts["mbd_load_work_J"].get<double>(), work, 1e-12);
  EXPECT_NEAR(facts["mbd_energy_drift_J"].get<double>(), 0, 1e-5 * std::abs(work));
}

TEST(MbdSolver, RestoredRunContinuesToTheSameBits) {
  MbdSolver solver;
  solver.configure(machines::menagerie());
  for (std::uint64_t n = 0; n < 20; ++n) solver.advance(loads(n, walls));
  solver.save();
  for (std::uint64_t n = 20; n < 40; ++n) solver.advance(loads(n, walls));
  const std::string straight = hash(solver.state());
  for (int again = 0; again < 2; ++again) {
    solver.restore();
    // Another path first, then a second restore.
    solver.advance(loads(20, {3}));
    solver.restore();
    for (std::uint64_t n = 20; n < 40; ++n) {
      solver.predict(window(n));
      solver.observe();
      solver.advance(loads(n, walls));
    }
    EXPECT_EQ(hash(solver.state()), straight);
  }
  MbdSolver twin;
  twin.configure(machines::menagerie());
  for (std::uint64_t n = 0; n < 40; ++n) twin.advance(loads(n, walls));
  EXPECT_EQ(hash(twin.state()), straight);
  EXPECT_EQ(nlohmann::json::parse(twin.report().facts)["mbd_state_hash"], straight);
}

TEST(MbdSolver, ReadsTheSceneThatTheCoordinatorSends) {
  protocol::Configuration configuration;
  configuration.origin = "pendulum.json";
  configuration.scene_text = R"({
    "tandem": "1.0", "name": "pendulum", "gravity": [0, -9.81, 0], "end_time": 1, "coupling": {"window": 1e-3},
    "mbd": {"bodies": [{"name": "mass", "mass": 1, "inertia": [1e-3, 1e-3, 1e-3, 0, 0, 0], "position": [-1, 0, 0]}],
            "joints": [{"name": "pin", "type": "revolute", "parent": "ground", "child": "mass", "position": [0, 0, 0],
                        "axis": [0, 0, 1]}]}})";
  MbdSolver solver;
  const protocol::Configured configured = solver.configure(configuration);
  EXPECT_TRUE(configured.boundary.empty());
  for (std::uint64_t n = 0; n < 1000; ++n) solver.advance(loads(n, {}));
  const protocol::BodiesFrame& frame = solver.observe();
  EXPECT_EQ(frame.time.count, 1000 * window_length);
  EXPECT_NEAR(frame.bodies[0].pose.p_WB.y, -0.165, 1e-2);
  configuration.scene_text = "{";
  EXPECT_THROW(solver.configure(configuration), Error);
}

// ---- control inputs

// A wheel with a motor, and a second wheel with a motor of the opposite sign.
scene::Scene controlled_wheel() {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId wheel = machines::add_body(scene, "wheel", 1, {.4, .4, .4}, {0, 0, 0});
  machines::add_joint(scene, "axle", scene::JointType::revolute, ground, wheel, {0, 0, 0});
  for (const char* input : {"drive", "brake"})
    scene.mbd->forces.push_back(scene::Actuator{input, JointId{0}, scene::ConstantMotion{}, input});
  return scene;
}

TEST(MbdSolver, HoldsControlInputsOverAWindow) {
  MbdSolver solver;
  solver.configure(controlled_wheel());
  EXPECT_NE(solver.capabilities() & protocol::can_control, 0u);
  double q = 0, u = 0;
  for (std::uint64_t n = 0; n < 100; ++n) {
    const double drive = std::sin(double(n)), brake = n % 3 == 0 ? -.7 : 0;
    solver.control({window(n).begin, {drive, brake}});
    solver.advance(loads(n, {}));
    const double a = (drive + brake) / .4;
    q += 1e-3 * u + .5e-6 * a;
    u += 1e-3 * a;
    EXPECT_NEAR(solver.state().q[0], q, 1e-15) << n;
    EXPECT_NEAR(solver.state().u[0], u, 1e-14) << n;
  }
  EXPECT_NEAR(nlohmann::json::parse(solver.report().facts)["mbd_energy_drift_J"].get<double>(), 0, 1e-13);
}

TEST(MbdSolver, RestoresControlInputs) {
  MbdSolver solver;
  solver.configure(controlled_wheel());
  solver.control({{0}, {1, 2}});
  solver.advance(loads(0, {}));
  solver.save();
  const std::string before = hash(solver.state());
  solver.control({window(1).begin, {3, 4}});
  EXPECT_NE(hash(solver.state()), before);
  solver.restore();
  EXPECT_EQ(hash(solver.state()), before);
  EXPECT_EQ(solver.state().inputs, (VectorXd(2) << 1, 2).finished());
}

TEST(MbdSolver, RefusesControlInputsThatDoNotFit) {
  MbdSolver solver;
  EXPECT_THROW(solver.control({{0}, {1, 2}}), Error);
  solver.configure(controlled_wheel());
  EXPECT_THROW(solver.control({{0}, {1}}), Error);
  EXPECT_NO_THROW(solver.control({{0}, {1, 2}}));
}

TEST(MbdSolver, RefusesWindowsAndLoadsThatDoNotFit) {
  MbdSolver solver;
  EXPECT_THROW(solver.predict(window(0)), Error);
  solver.configure(machines::menagerie());
  EXPECT_THROW(solver.predict(window(1)), Error);
  EXPECT_THROW(solver.advance(loads(1, walls)), Error);
  EXPECT_THROW(solver.advance(loads(0, {2})), Error);  // has no wall
  EXPECT_NO_THROW(solver.advance(loads(0, {3, ground.value})));
}

TEST(MbdSolver, RunsAMachineWithoutFreedoms) {
  scene::Scene scene = machines::empty();
  const BodyId box = machines::add_body(scene, "box", 10, {1, 1, 1}, {0, 0, 0});
  machines::add_joint(scene, "bolt", scene::JointType::fixed, ground, box, {0, 0, 0});
  machines::add_wall(scene, box);
  MbdSolver solver;
  solver.configure(scene);
  solver.predict(window(0));
  LoadSet set = loads(0, {0});
  const BodyMotion& motion = solver.advance(set).bodies[0];
  EXPECT_EQ(motion.end_pose.p_WB, Vec3d{});
  EXPECT_EQ(motion.end_a, Vec3d{});
  const Wrench& reaction = solver.observe().joints[0].reaction;
  EXPECT_LT(norm(reaction.force + set.bodies[0].mean.force - Vec3d{0, 0, 98.1}), 1e-12);
}

}  // namespace
}  // namespace tandem::mbd
