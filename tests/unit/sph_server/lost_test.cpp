// Liquid that leaves the domain, accessed through the interface of a participant.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/log.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace lost_test {

using protocol::LoadSet;
using protocol::ParticleAccount;

constexpr double g = 9.81, window = 2e-3, spacing = 0.01, bottom = -0.1;  // [m/s2], [s], [m], [m]
constexpr double particle_mass = 1000 * spacing * spacing * spacing;      // [kg]

// 4 x 4 x 6 spacings of liquid without walls, which fall out of the domain.
nlohmann::json falling_block() {
  return nlohmann::json::parse(R"({
    "tandem": "1.1", "name": "block", "end_time": 1, "coupling": {"window": 0.002},
    "sph": {
      "spacing": 0.01,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "expected_speed": 2, "pressure": "zero",
                   "fill": [{"type": "box", "min": [-0.02, -0.02, 0], "max": [0.02, 0.02, 0.06]}]}],
      "domain": {"min": [-0.1, -0.1, -0.1], "max": [0.1, 0.1, 0.1]}
    }
  })");
}

// A column that collapses on a plate: it flows over the edges of the plate, and falls out of the domain.
nlohmann::json collapsing_column() {
  nlohmann::json scene = falling_block();
  scene["sph"]["liquids"][0]["pressure"] = "hydrostatic";
  scene["sph"]["liquids"][0]["artificial_viscosity"] = 0.1;
  scene["sph"]["walls"] = nlohmann::json::parse(
      R"([{"name": "plate", "position": [0, 0, -0.02], "shape": {"type": "box", "size": [0.08, 0.08, 0.04]}}])");
  return scene;
}

class LosingRun {
 public:
  explicit LosingRun(const nlohmann::json& scene, unsigned threads = 1) {
    log::setup("test", "error");
    protocol::Configuration c;
    c.scene_text = scene.dump();
    c.origin = "losing.json";
    c.backend = "cpu";
    c.threads = threads;
    facts = nlohmann::json::parse(solver->configure(c).facts);
  }
  const LoadSet& advance() {
    protocol::MotionSet motion;
    motion.window = {index++, now, now + to_nanoseconds(window)};
    now = motion.window.end;
    const LoadSet& loads = solver->advance(motion);
    const ParticleAccount& a = loads.account;
    Vec3d given = a.gravity_impulse;
    for (const auto& body : loads.bodies) given -= window * body.mean.force;
    open = std::max({open, norm(a.momentum_begin - momentum),
                     norm(a.momentum_end - a.momentum_begin + a.lost_momentum - given)});
    scale = std::max(scale, norm(a.momentum_end));
    momentum = a.momentum_end;
    lost_momentum += a.lost_momentum;
    return loads;
  }
  void run_to(std::uint64_t windows) {
    while (index < windows) advance();
  }
  nlohmann::json report() { return nlohmann::json::parse(solver->report().facts); }

  std::unique_ptr<protocol::LoadSolver> solver = sph::make_solver();
  nlohmann::json facts;
  std::uint64_t index = 0;
  Nanoseconds now;
  Vec3d momentum, lost_momentum;
  double open = 0, scale = 0;  // largest residual of the momentum of a window, largest momentum [kg m/s]
};

void expect_about(const char* what, double expected, double measured, double tolerance) {
  std::printf("  %-50s expected %12.6g  measured %12.6g  tolerance %8.2g\n", what, expected, measured,
              tolerance);
  EXPECT_LE(std::fabs(measured - expected), tolerance) << what;
}

double residual_of_energy(const nlohmann::json& report) {
  return report["energy_residual_J"].get<double>() / report["energy_scale_J"].get<double>();
}

// Particles at z fall out at the time sqrt(2 (z - bottom) / g), layer by layer, with the speed of that fall.
TEST(Lost, LayersOfAFallingBlockLeaveWhenAFreeFallReachesTheEnd) {
  for (const char* precision : {"mixed", "double"}) {
    nlohmann::json scene = falling_block();
    scene["sph"]["precision"] = precision;
    LosingRun run(scene);
    EXPECT_EQ(run.facts["particles"], 96);
    double momentum = 0, energy = 0;
    std::uint64_t lost = 0;
    for (int layer = 0; layer < 6; ++layer) {
      const double fall = (layer + 0.5) * spacing - bottom, last = std::sqrt(2 * fall / g);
      // A particle is found after 0.15 spacings of its way at the latest, and at the end of a step.
      const double found = std::sqrt(2 * (fall + 0.2 * spacing) / g);
      while (to_seconds(run.now) < last) {
        EXPECT_EQ(lost, static_cast<std::uint64_t>(16 * layer)) << precision << " at " << to_seconds(run.now);
        lost = run.advance().account.lost_particles;
      }
      while (to_seconds(run.now) < found) lost = run.advance().account.lost_particles;
      EXPECT_EQ(lost, static_cast<std::uint64_t>(16 * (layer + 1)))
          << precision << " at " << to_seconds(run.now);
      EXPECT_EQ(run.solver->observe().id.size(), 96 - lost);
      momentum -= 16 * particle_mass * g * last;
      energy += 16 * particle_mass * g * fall;
    }
    run.advance();  // without particles
    const nlohmann::json r = run.report();
    std::printf("falling block, %s\n", precision);
    expect_about("mass that left [kg]", 96 * particle_mass, r["lost_kg"], 1e-12);
    expect_about("mass in all [kg]", 96 * particle_mass, r["mass_in_all_kg"], 1e-12);
    expect_about("momentum that left [kg m/s]", momentum, run.lost_momentum.z, 0.01 * std::fabs(momentum));
    expect_about("energy that left [J]", -energy, r["work_J"]["lost"], 0.02 * energy);
    expect_about("residual of the momentum of a window / momentum", 0, run.open / run.scale, 1e-6);
    expect_about("residual of the energy / energy that moved", 0, residual_of_energy(r), 1e-3);
    EXPECT_NE(r["warnings"].dump().find("96 particles of the liquid, 0.096 kg, have left the domain"),
              std::string::npos)
        << r["warnings"];
  }
}

TEST(Lost, BalancesOfAColumnThatCollapsesClose) {
  LosingRun run(collapsing_column());
  run.run_to(150);
  const nlohmann::json r = run.report();
  const std::vector<std::uint32_t> id = run.solver->observe().id;
  EXPECT_GT(r["lost_particles"], 30);
  EXPECT_FALSE(id.empty()) << "some of it stays on the plate";
  EXPECT_EQ(id.size() + r["lost_particles"].get<std::size_t>(), 96u);
  EXPECT_TRUE(std::ranges::adjacent_find(id, std::greater_equal{}) == id.end()) << "numbers ascend";
  EXPECT_EQ(r["passed_walls"], 0);
  std::printf("column on a plate: %d of 96 particles left\n", r["lost_particles"].get<int>());
  expect_about("residual of the momentum of a window / momentum", 0, run.open / run.scale, 1e-6);
  expect_about("residual of the energy / energy that moved", 0, residual_of_energy(r), 0.01);
}

TEST(Lost, HasTheSameBitsAfterRollbackRestartAndOverThreads) {
  const nlohmann::json scene = collapsing_column();
  LosingRun whole(scene);
  whole.run_to(90);
  const std::uint64_t lost_then = whole.report()["lost_particles"];
  whole.run_to(110);
  const nlohmann::json expected = whole.report();
  EXPECT_GT(lost_then, 0u);
  EXPECT_GT(expected["lost_particles"], lost_then) << "particles must leave before and after the copy";
  const auto expect_same = [&](LosingRun& run, const char* what) {
    const nlohmann::json r = run.report();
    for (const char* key : {"state_hash", "lost_particles", "lost_kg", "energy_residual_J"})
      EXPECT_EQ(r[key], expected[key]) << what << ": " << key;
    EXPECT_EQ(r["work_J"], expected["work_J"]) << what;
    EXPECT_EQ(run.solver->observe().id, whole.solver->observe().id) << what;
  };
  LosingRun threads(scene, 3);
  threads.run_to(110);
  expect_same(threads, "three threads");

  const auto file = std::filesystem::temp_directory_path() / "tandem_lost_test.state";
  LosingRun begun(scene);
  begun.run_to(90);
  begun.solver->checkpoint({90, begun.now, file.string()});
  begun.solver->save();
  const Nanoseconds then = begun.now;
  for (int repeat = 0; repeat < 2; ++repeat) {
    begun.index = 90;
    begun.now = then;
    begun.run_to(110);
    expect_same(begun, "rollback");
    begun.solver->restore();
  }
  LosingRun resumed(scene);
  resumed.solver->resume({90, then, file.string()});
  resumed.index = 90;
  resumed.now = then;
  resumed.run_to(110);
  expect_same(resumed, "restart");
  nlohmann::json fewer = scene;
  fewer["sph"]["liquids"][0]["fill"][0]["max"][2] = 0.05;
  EXPECT_NE(error_of([&] {
              LosingRun(fewer).solver->resume({90, then, file.string()});
            }).find("is a state of particles at the start: 96, the scene has 80"),
            std::string::npos);
  std::filesystem::remove(file);
}

TEST(Lost, LiquidThatStartsOutsideTheDomainIsRefused) {
  nlohmann::json scene = collapsing_column();
  scene["sph"]["walls"].push_back(nlohmann::json::parse(
      R"({"name": "cup", "position": [0, 0.15, 0], "shape": {"type": "box", "size": [0.04, 0.04, 0.04], "open": ["+z"]}})"));
  scene["sph"]["liquids"][0]["fill"] =
      nlohmann::json::parse(R"([{"type": "inside", "wall": "cup", "level": 0.01}])");
  EXPECT_NE(error_of([&] { LosingRun run(scene); }).find("outside the domain"), std::string::npos);
}

}  // namespace lost_test
}  // namespace tandem::test
