// The solver of liquids, accessed through the interface of a participant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using protocol::BodyMotion;
using protocol::LoadSet;

constexpr double window = 2e-3;
constexpr double amplitude = 0.01, omega = 12;  // of the basin along x [m], [rad/s]

// A basin on a body, with water of depth 0.08 m.
nlohmann::json basin() {
  return nlohmann::json::parse(R"({
    "tandem": "1.1", "name": "basin", "end_time": 1, "coupling": {"window": 0.002},
    "mbd": {"bodies": [{"name": "basin", "mass": 5, "inertia": [1, 1, 1], "position": [0, 0, 0.1]}]},
    "sph": {
      "spacing": 0.02,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "artificial_viscosity": 0.1,
                   "fill": [{"type": "box", "min": [-0.06, -0.04, 0], "max": [0.06, 0.04, 0.08]}]}],
      "walls": [{"name": "case", "body": "basin", "shape": {"type": "box", "size": [0.12, 0.08, 0.2], "open": ["+z"]}}],
      "domain": {"min": [-0.3, -0.3, -0.1], "max": [0.3, 0.3, 0.5]}
    }
  })");
}

// At rest, or moved along x from t = 0 on: x = A (1 - cos w t).
class BasinRun {
 public:
  explicit BasinRun(const nlohmann::json& scene = basin(), unsigned threads = 1) {
    log::setup("test", "error");
    protocol::Configuration c;
    c.scene_text = scene.dump();
    c.origin = "basin.json";
    c.backend = "cpu";
    c.threads = threads;
    facts = nlohmann::json::parse(solver->configure(c).facts);
  }

  const LoadSet& advance(bool moves) {
    protocol::MotionSet motion;
    motion.window = {index, now, now + to_nanoseconds(window)};
    BodyMotion& body = motion.bodies.emplace_back();
    body.body = 0;
    const auto pose = [&](Nanoseconds t) {
      return Pose{{moves ? amplitude * (1 - std::cos(omega * to_seconds(t))) : 0, 0, 0.1}, {}};
    };
    const auto twist = [&](Nanoseconds t) {
      return Twist{{moves ? amplitude * omega * std::sin(omega * to_seconds(t)) : 0, 0, 0}, {}};
    };
    body.begin_pose = pose(motion.window.begin);
    body.end_pose = pose(motion.window.end);
    body.begin_twist = twist(motion.window.begin);
    body.end_twist = twist(motion.window.end);
    ++index;
    now = motion.window.end;
    return solver->advance(motion);
  }
  std::string hash() { return nlohmann::json::parse(solver->report().facts)["state_hash"]; }

  std::unique_ptr<protocol::LoadSolver> solver = sph::make_solver();
  nlohmann::json facts;
  std::uint64_t index = 0;
  Nanoseconds now;
};

void expect_near(const char* what, double expected, double measured, double tolerance) {
  std::printf("%s: expected %.8g, measured %.8g, tolerance %.3g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

TEST(SphSolver, LoadsTheBasinByItsWeight) {
  BasinRun run;
  EXPECT_EQ(run.facts["particles"], 6 * 4 * 4);
  const double weight = 6 * 4 * 4 * 1000 * std::pow(0.02, 3) * 9.81;
  for (int i = 0; i < 100; ++i) run.advance(false);
  Vec3d force;
  for (int i = 0; i < 50; ++i) force += (1.0 / 50) * run.advance(false).bodies.at(0).mean.force;
  expect_near("force along z [N]", -weight, force.z, 0.005 * weight);
  expect_near("force along x [N]", 0, force.x, 0.005 * weight);
}

TEST(SphSolver, MomentumAndWorkCloseInEachWindow) {
  BasinRun run;
  double worst = 0, scale = 0, work = 0;
  Vec3d momentum;
  for (int i = 0; i < 100; ++i) {
    const LoadSet& loads = run.advance(true);
    const protocol::ParticleAccount& a = loads.account;
    const Vec3d given = a.gravity_impulse - window * loads.bodies.at(0).mean.force;
    if (i > 0) worst = std::max(worst, norm(a.momentum_begin - momentum));
    worst = std::max(worst, norm(a.momentum_end - a.momentum_begin - given));
    scale = std::max({scale, norm(a.gravity_impulse), norm(given)});
    momentum = a.momentum_end;
    work += loads.bodies.at(0).work;
    expect_near("micro steps times their length [s]", window,
                static_cast<double>(a.micro_steps) * a.micro_step, 1e-12);
  }
  expect_near("largest open momentum of a window / impulse of gravity", 0, worst / scale, 1e-6);
  // The liquid records the work of the walls by itself.
  const nlohmann::json report = nlohmann::json::parse(run.solver->report().facts);
  const double of_walls = report["work_J"]["walls"];
  expect_near("work on the basin [J], by the loads and by the liquid", -of_walls, work,
              0.05 * std::fabs(of_walls) + 1e-5);
  expect_near("residual of the energy / energy that moved", 0,
              report["energy_residual_J"].get<double>() / report["energy_scale_J"].get<double>(), 0.01);
  EXPECT_EQ(report["passed_walls"], 0);
}

bool same(const LoadSet& a, const LoadSet& b) {
  return a.bodies.at(0).mean.force == b.bodies.at(0).mean.force &&
         a.bodies.at(0).mean.torque == b.bodies.at(0).mean.torque &&
         a.bodies.at(0).work == b.bodies.at(0).work && a.account.momentum_end == b.account.momentum_end &&
         a.account.micro_steps == b.account.micro_steps;
}

TEST(SphSolver, RollbackGivesTheSameBits) {
  for (const char* precision : {"mixed", "double"}) {
    nlohmann::json scene = basin();
    scene["sph"]["precision"] = precision;
    BasinRun run(scene);
    for (int i = 0; i < 30; ++i) run.advance(true);
    run.solver->save();
    const auto [index, now] = std::pair(run.index, run.now);
    std::vector<LoadSet> first;
    for (int i = 0; i < 20; ++i) first.push_back(run.advance(true));
    const std::string hash = run.hash();
    for (int again = 0; again < 2; ++again) {
      run.solver->restore();
      run.index = index, run.now = now;
      if (again == 1) {
        for (int i = 0; i < 5; ++i) run.advance(false);  // a window that is taken back leaves nothing
        run.solver->restore();
        run.index = index, run.now = now;
      }
      for (const LoadSet& loads : first) EXPECT_TRUE(same(run.advance(true), loads)) << precision;
      EXPECT_EQ(run.hash(), hash) << precision;
    }
  }
}

TEST(SphSolver, AFileContinuesWithTheSameBits) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "tandem_sph_solver_test.h5";
  BasinRun run;
  for (int i = 0; i < 30; ++i) run.advance(true);
  const protocol::Checkpoint order{run.index, run.now, file.string()};
  run.solver->checkpoint(order);
  BasinRun other;
  other.solver->resume(order);
  other.index = run.index, other.now = run.now;
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(same(other.advance(true), run.advance(true))) << i;
  EXPECT_EQ(other.hash(), run.hash());

  nlohmann::json scene = basin();
  scene["sph"]["precision"] = "double";
  try {
    BasinRun(scene).solver->resume(order);
    FAIL() << "a state of another precision was read";
  } catch (const Error& error) {
    EXPECT_NE(error.problem().find("is a state of precision mixed, the scene has double"), std::string::npos)
        << error.what();
  }
  std::filesystem::remove(file);
}

TEST(SphSolver, ThreadsGiveTheSameBits) {
  BasinRun one(basin(), 1), three(basin(), 3);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(same(one.advance(true), three.advance(true)));
  EXPECT_EQ(one.hash(), three.hash());
}

TEST(SphSolver, FramesHavePressureAndDensity) {
  BasinRun run;
  for (int i = 0; i < 100; ++i) run.advance(false);
  run.solver->snapshot();
  const protocol::ParticlesFrame frame = run.solver->observe();
  ASSERT_EQ(frame.liquid.size(), 2 * frame.id.size());
  double lowest = 0, count = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    EXPECT_EQ(frame.radius[i], 0.01f);
    if (frame.position[3 * i + 2] > 0.02) continue;
    lowest += static_cast<double>(frame.liquid[2 * i]);
    ++count;
  }
  expect_near("mean pressure of the lowest layer [Pa]", 1000 * 9.81 * 0.07, lowest / count, 40);
  run.advance(true);
  const protocol::ParticlesFrame& kept = run.solver->read_snapshot();
  EXPECT_TRUE(kept.position == frame.position && kept.velocity == frame.velocity &&
              kept.liquid == frame.liquid && kept.time == frame.time);
}

// Moved along x the basin first radiates sound from its two ends, and in the end has moved all of the water.
// What was measured leaves the liquid as it was.
TEST(SphSolver, RespondsToAStepOfTheVelocity) {
  nlohmann::json scene = basin(), heavy = basin();
  scene["mbd"]["joints"] = {{{"name", "rail"},
                             {"type", "prismatic"},
                             {"parent", "ground"},
                             {"child", "basin"},
                             {"position", {0, 0, 0}},
                             {"axis", {1, 0, 0}}}};
  heavy["mbd"]["bodies"][0]["mass"] = 1e9;
  heavy["mbd"]["bodies"][0]["inertia"] = {1e9, 1e9, 1e9};
  BasinRun run(scene), other(heavy);
  const std::vector<protocol::BodyResponse> responses = run.solver->linearise().responses;
  EXPECT_TRUE(other.solver->linearise().responses.empty()) << "a body that no liquid moves";
  ASSERT_EQ(responses.size(), 12u);
  const double c = run.facts["sound_speed_m_per_s"], radiation = 1000 * c * 2 * 0.08 * 0.08;
  expect_near("damping at first [N s/m]", radiation,
              (responses[5].impulse[0] - responses[2].impulse[0]) / (responses[5].time - responses[2].time),
              0.25 * radiation);
  EXPECT_EQ(responses[5].impulse[7], 0) << "no other direction";
  EXPECT_NEAR(responses[1].impulse[0], 0, 1e-3) << "the load answers after two steps";
  for (int i = 0; i < 10; ++i) {
    run.advance(true);
    other.advance(true);
  }
  EXPECT_EQ(run.hash(), other.hash());
}

TEST(SphSolver, RefusesWallsInsideTheLiquid) {
  const auto refusal = [](double height) {
    nlohmann::json scene = basin();
    scene["sph"]["walls"].push_back({{"name", "plate"},
                                     {"position", {0.01, 0, height}},
                                     {"shape", {{"type", "box"}, {"size", {0.02, 0.02, 0.02}}}}});
    return error_of([&] { BasinRun run(scene); });
  };
  EXPECT_THAT(refusal(0.05),
              testing::HasSubstr("sph.liquids[0].fill[0]: wall 'plate' passes through the box"));
  // Above the particles of the highest layer.
  EXPECT_THAT(refusal(0.084), testing::HasSubstr("sph.liquids[0].fill[0]: a particle starts at"));
  EXPECT_THAT(refusal(0.084), testing::HasSubstr("nearer than 0.006 m to wall 'plate'"));
  EXPECT_EQ(refusal(0.1), "no error");
}

}  // namespace
}  // namespace tandem::test
