// Liquid that comes in and goes out, accessed through the interface of a participant.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/log.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "sph_server/io/inlets.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using protocol::LoadSet;
using protocol::ParticleAccount;

constexpr double traffic_window = 2e-3;

// A channel along x, 4 x 4 spacings, with an inlet at its end; an outlet beyond the other one.
nlohmann::json channel() {
  return nlohmann::json::parse(R"({
    "tandem": "1.1", "name": "channel", "end_time": 10, "gravity": [0, 0, 0], "coupling": {"window": 0.002},
    "sph": {
      "spacing": 0.01,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "artificial_viscosity": 0.1, "fill": []}],
      "wall_friction": "free_slip",
      "walls": [{"name": "channel", "position": [0.1, 0, 0.02],
                 "shape": {"type": "box", "size": [0.2, 0.04, 0.04], "open": ["+x", "-x"]}}],
      "inlets": [{"name": "pipe", "position": [0, 0, 0.02], "orientation": {"axis": [0, 1, 0], "angle_deg": 90},
                  "shape": {"type": "rectangle", "size": [0.04, 0.04]}, "velocity": 0.5}],
      "outlets": [{"name": "drain", "region": {"type": "plane", "point": [0.06, 0, 0], "normal": [1, 0, 0]}}],
      "domain": {"min": [-0.05, -0.1, -0.1], "max": [0.4, 0.1, 0.1]}
    }
  })");
}

class TrafficRun {
 public:
  explicit TrafficRun(const nlohmann::json& scene = channel(), unsigned threads = 1) {
    log::setup("test", "error");
    protocol::Configuration c;
    c.scene_text = scene.dump();
    c.origin = "channel.json";
    c.backend = "cpu";
    c.threads = threads;
    solver->configure(c);
  }
  const LoadSet& advance() {
    protocol::MotionSet motion;
    motion.window = {index++, now, now + to_nanoseconds(traffic_window)};
    now = motion.window.end;
    return solver->advance(motion);
  }
  nlohmann::json report() { return nlohmann::json::parse(solver->report().facts); }

  std::unique_ptr<protocol::LoadSolver> solver = sph::make_solver();
  std::uint64_t index = 0;
  Nanoseconds now;
};

void expect_about(const char* what, double expected, double measured, double tolerance) {
  std::printf("  %-50s expected %12.6g  measured %12.6g  tolerance %8.2g\n", what, expected, measured,
              tolerance);
  EXPECT_LE(std::fabs(measured - expected), tolerance) << what;
}

double mean_height(TrafficRun& run) {
  const protocol::ParticlesFrame& frame = run.solver->observe();
  double sum = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i) sum += frame.position[3 * i + 2];
  return sum / static_cast<double>(frame.id.size());
}

TEST(Inlet, HasLayersOfParticlesAndAPiston) {
  scene::Sph sph;
  sph.spacing = 0.01;
  scene::LiquidInlet of;
  of.shape = scene::RectangleShape{0.04, 0.02};
  of.flow = 4e-4;  // 0.5 m/s
  of.start = 1;
  of.end = 2;
  sph.inlets = {of, of};
  sph.inlets[1].shape = scene::DiscShape{0.03};
  const std::vector<sph::Inlet> inlets = sph::inlets_of(sph);
  EXPECT_EQ(inlets[0].site.size(), 8u);
  EXPECT_NEAR(inlets[0].thickness, 0.01, 1e-15);
  EXPECT_NEAR(inlets[0].due(0), 1.02, 1e-12);
  EXPECT_EQ(inlets[0].layers_until(1.5), 25u);
  EXPECT_EQ(inlets[0].layers_until(9), 50u);
  EXPECT_NEAR(inlets[0].pose(1.01, 0).p.z, 0.005 + 1e-6, 1e-12);
  EXPECT_NEAR(inlets[0].pose(1.03, 1).p.z, 0.005 + 1e-6, 1e-12);
  EXPECT_EQ(inlets[0].pose(0.5, 0).v.z, 0);
  EXPECT_NEAR(inlets[0].pose(1.5, 25).v.z, 0.5, 1e-12);
  EXPECT_EQ(inlets[0].pose(2.5, 50).v.z, 0);
  // The volume of a layer of the disc is that of its particles.
  const double area = of.flow.value() / sph.inlets[1].speed();
  EXPECT_NEAR(inlets[1].thickness * area, 1e-6 * static_cast<double>(inlets[1].site.size()), 1e-15);
}

// It is looked into between two windows, which must not disturb what the steps need.
TEST(Outlet, WithoutLiquidInItChangesNothing) {
  nlohmann::json scene = channel();
  scene["gravity"] = {0, 0, -9.81};
  scene["sph"].erase("inlets");
  scene["sph"]["walls"][0]["shape"].erase("open");
  scene["sph"]["liquids"][0]["expected_speed"] = 1;
  scene["sph"]["liquids"][0]["fill"] =
      nlohmann::json::parse(R"([{"type": "box", "min": [0, -0.02, 0], "max": [0.08, 0.02, 0.03]}])");
  scene["sph"]["outlets"][0]["region"]["point"] = {0.3, 0, 0};
  TrafficRun with(scene);
  scene["sph"].erase("outlets");
  TrafficRun without(scene);
  for (int k = 0; k < 4; ++k) {
    const Vec3d force = with.advance().bodies.at(0).mean.force,
                expected = without.advance().bodies.at(0).mean.force;
    EXPECT_TRUE(force == expected);
  }
  EXPECT_EQ(with.solver->observe().position, without.solver->observe().position);
}

TEST(Inlet, IsRefusedWhereAWallPassesThroughIt) {
  nlohmann::json scene = channel();
  scene["sph"]["inlets"][0]["position"] = {0, 0.02, 0.02};
  const std::string refused = error_of([&] { TrafficRun run(scene); });
  EXPECT_TRUE(refused.starts_with(
      "scene: sph.inlets[0]: wall 'channel' passes through the inlet 'pipe': it is between the middle of the "
      "inlet and the particle that comes in at ["))
      << refused;
  EXPECT_TRUE(refused.ends_with("(let the shape of the inlet end at the walls of its nozzle or channel)"))
      << refused;
  // The outermost particles may be nearer to walls than half a spacing.
  scene["sph"]["inlets"][0]["position"] = {0, 0.002, 0.02};
  EXPECT_EQ(error_of([&] { TrafficRun run(scene); }), "no error");
}

TEST(Inlet, IsRefusedInLiquidAndInAnotherInlet) {
  nlohmann::json scene = channel();
  scene["sph"]["liquids"][0]["fill"] = {
      {{"type", "box"}, {"min", {-0.02, -0.02, 0}}, {"max", {0.04, 0.02, 0.04}}}};
  EXPECT_TRUE(
      error_of([&] {
        TrafficRun run(scene);
      }).starts_with("scene: sph.liquids[0].fill[0]: inlet 'pipe' passes through the box, between ["));
  scene["sph"]["liquids"][0]["fill"][0]["min"][0] = 0;
  EXPECT_EQ(error_of([&] { TrafficRun run(scene); }), "no error") << "the box ends at the inlet";
  scene = channel();
  nlohmann::json other = scene["sph"]["inlets"][0];
  other["name"] = "other";
  other["position"][0] = 0.002;
  scene["sph"]["inlets"].push_back(other);
  const std::string refused = error_of([&] { TrafficRun run(scene); });
  EXPECT_TRUE(refused.starts_with("scene: sph.inlets[1]: a particle of the inlet 'other' comes in at ["))
      << refused;
  EXPECT_TRUE(
      refused.ends_with("m, less than half a spacing from one of the inlet 'pipe' (move one of them by a "
                        "spacing, or leave it out)"))
      << refused;
}

TEST(Inlet, ThatStartsAfterTheEndIsWarnedOf) {
  nlohmann::json scene = channel();
  scene["sph"]["inlets"][0]["start"] = 20;
  TrafficRun run(scene);
  const std::string report = run.report().dump();
  EXPECT_NE(report.find("inlet 'pipe' starts at 20 s, so that no liquid comes in before the end at 10 s"),
            std::string::npos)
      << report;
}

TEST(Inlet, FillsAChannelAndTheDrainEmptiesIt) {
  TrafficRun run;
  double worst = 0, scale = 0;
  Vec3d before;
  ParticleAccount a;
  for (int i = 0; i < 160; ++i) {
    const LoadSet& loads = run.advance();
    a = loads.account;
    Vec3d given = a.gravity_impulse;
    for (const auto& body : loads.bodies) given -= traffic_window * body.mean.force;
    worst = std::max({worst, norm(a.momentum_begin - before),
                      norm(a.momentum_end - a.momentum_begin + a.lost_momentum - given)});
    scale = std::max(scale, norm(a.momentum_end));
    before = a.momentum_end;
  }
  const nlohmann::json r = run.report();
  const double area = 0.04 * 0.04, time = 160 * traffic_window;
  expect_about("mass that came in [kg]", 1000 * area * 0.5 * time, r["inlets"]["pipe"]["mass_kg"],
               1000 * area * 0.0101);
  // The stream fills the channel up to the outlet.
  const double came = r["came_in"], went = r["went_out"];
  expect_about("particles between inlet and outlet", 16 * 6, came - went, 20);
  expect_about("open momentum of a window / momentum", 0, worst / scale, 1e-6);
  expect_about("mean velocity [m/s]", 0.5, a.momentum_end.x / (0.001 * (came - went)), 0.025);
  expect_about("residual of the energy / energy that moved", 0,
               r["energy_residual_J"].get<double>() / r["energy_scale_J"].get<double>(), 0.01);
  EXPECT_EQ(r["passed_walls"], 0);
}

// Liquid comes in below the surface of a basin and raises it. The domain has room for 10^8 particles: that
// takes neither memory nor digits of the energy.
TEST(Inlet, RaisesABasin) {
  nlohmann::json scene = channel();
  scene["sph"]["domain"] = {{"min", {-2, -2, -2}}, {"max", {3, 3, 2}}};
  scene["gravity"] = {0, 0, -9.81};
  scene["sph"]["outlets"] = nlohmann::json::array();
  scene["sph"]["liquids"][0]["fill"] =
      nlohmann::json::parse(R"([{"type": "box", "min": [0, -0.02, 0], "max": [0.04, 0.02, 0.04]}])");
  scene["sph"]["walls"][0]["shape"]["open"] = {"-x"};
  scene["sph"]["walls"][0]["position"] = {0.05, 0, 0.02};
  scene["sph"]["walls"][0]["shape"]["size"] = {0.1, 0.04, 0.04};
  scene["sph"]["inlets"][0]["velocity"] = 0.2;
  scene["sph"]["inlets"][0]["end"] = 0.2;
  TrafficRun run(scene);
  for (int i = 0; i < 120; ++i) run.advance();
  const nlohmann::json r = run.report();
  expect_about("particles that came in", 16 * 4, r["came_in"], 0);
  EXPECT_EQ(r["passed_walls"], 0);
  expect_about("residual of the energy / energy that moved", 0,
               r["energy_residual_J"].get<double>() / r["energy_scale_J"].get<double>(), 0.01);
  // 64 particles were there; twice as many fill the basin half as long again.
  expect_about("height of the centre of mass [m]", 0.5 * 128e-6 / (0.1 * 0.04), mean_height(run), 0.004);
}

TEST(Inlet, HasTheSameBitsAfterRollbackRestartAndOverThreads) {
  nlohmann::json scene = channel();
  scene["gravity"] = {0, 0, -9.81};
  const auto run_to = [](TrafficRun& run, int windows) {
    while (run.index < static_cast<std::uint64_t>(windows)) run.advance();
  };
  TrafficRun whole(scene);
  run_to(whole, 80);
  const std::string hash = whole.report()["state_hash"];
  const std::uint64_t went = whole.report()["went_out"];
  EXPECT_GT(went, 0u) << "particles must have gone out";

  TrafficRun threads(scene, 3);
  run_to(threads, 80);
  EXPECT_EQ(threads.report()["state_hash"], hash);

  const auto file = std::filesystem::temp_directory_path() / "tandem_traffic_test.state";
  TrafficRun begun(scene);
  run_to(begun, 70);
  begun.solver->checkpoint({70, begun.now, file.string()});
  begun.solver->save();
  const auto then = begun.now;
  for (int repeat = 0; repeat < 2; ++repeat) {
    begun.index = 70;
    begun.now = then;
    run_to(begun, 80);
    EXPECT_EQ(begun.report()["state_hash"], hash);
    EXPECT_EQ(begun.report()["went_out"], went);
    begun.solver->restore();
  }
  TrafficRun resumed(scene);
  resumed.solver->resume({70, then, file.string()});
  resumed.index = 70;
  resumed.now = then;
  run_to(resumed, 80);
  EXPECT_EQ(resumed.report()["state_hash"], hash);
  EXPECT_EQ(resumed.report()["went_out"], went);
  EXPECT_EQ(resumed.solver->observe().id, whole.solver->observe().id);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace tandem::test
