// What spheres do to walls, on their triangles and as a whole: against the loads of bodies, the weight of a
// bed, and the closed form of a sphere that slides until it rolls; and that it has the same bits however it
// is run.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/error.hpp"
#include "dem_server/contact/wall_sums.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"

namespace tandem::test {
namespace {

constexpr double wall_dt = 2e-5;  // [s]
const std::vector<std::string> falling_walls = {"box", "plate", "post", "knob", "floor"};

// Spheres that fall on walls of all kinds, each with a sensor; two of them have fields.
std::string measured_walls(const std::string& law) {
  nlohmann::json all = nlohmann::json::parse(falling_spheres(law, "", 150));
  for (const std::string& wall : falling_walls)
    all["dem"]["sensors"].push_back({{"name", "on_" + wall}, {"wall", wall}});
  all["output"]["wall_fields"] = {"plate", "box"};
  return all.dump();
}

using Sums = std::vector<double>;  // of a triangle or a wall

Sums total(const std::vector<double>& rows, std::size_t first = 0, std::size_t end = ~std::size_t{0}) {
  Sums sum(dem::wall_sum_count);
  for (std::size_t i = first * dem::wall_sum_count;
       i < std::min(rows.size(), end == ~std::size_t{0} ? rows.size() : end * dem::wall_sum_count); ++i)
    sum[i % dem::wall_sum_count] += rows[i];
  return sum;
}

class WallSums : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Laws, WallSums,
                         testing::Values("hertz_mindlin", "hertz_frictionless", "paper", "hooke", "jkr"));

TEST_P(WallSums, AddUpToTheLoadOfTheBody) {
  ParticleRun run(measured_walls(GetParam()));
  constexpr std::uint32_t steps = 400;
  Vec3d impulse;
  std::vector<double> of_walls(falling_walls.size() * dem::wall_sum_count);
  for (int w = 0; w < 12; ++w) {
    const dem::WindowOutcome& outcome = run.advance(steps, wall_dt);
    for (const Wrench& load : outcome.load) impulse += wall_dt * load.force;
    ASSERT_EQ(outcome.wall_means.size(), of_walls.size());
    for (std::size_t i = 0; i < of_walls.size(); ++i) of_walls[i] += steps * wall_dt * outcome.wall_means[i];
  }
  const Sums all = total(of_walls);
  const std::vector<double> fields = run.engine->wall_fields();
  ASSERT_EQ(fields.size(), (12 + 10) * dem::wall_sum_count) << "triangles of the plate, then of the open box";
  const Sums plate = total(fields, 0, 12), box = total(fields, 12);
  std::printf("%s: impulse expected (%.6g, %.6g, %.6g) N s, measured (%.6g, %.6g, %.6g) N s\n", GetParam(),
              impulse.x, impulse.y, impulse.z, all[0], all[1], all[2]);
  EXPECT_GT(norm(impulse), 0.1);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(all[static_cast<std::size_t>(a)], impulse[a], 1e-9 * norm(impulse));
  for (std::size_t k = 0; k < dem::wall_sum_count; ++k) {
    const double size = std::abs(all[dem::wall_normal]) + 1e-3;
    EXPECT_NEAR(box[k], of_walls[k], 1e-9 * size) << k;
    EXPECT_NEAR(plate[k], of_walls[dem::wall_sum_count + k], 1e-9 * size) << k;
  }
  EXPECT_GT(plate[dem::wall_normal], 0);
  EXPECT_EQ(plate[dem::wall_shear] > 0, std::string(GetParam()) != "hertz_frictionless");
}

TEST_P(WallSums, HaveTheSameBitsHoweverTheyAreRun) {
  const std::string text = measured_walls(GetParam());
  ParticleRun one(text, particles::Backend::cpu, 1), three(text, particles::Backend::cpu, 3), resumed(text);
  for (int w = 0; w < 4; ++w) one.advance(400, wall_dt);
  for (int w = 0; w < 2; ++w) three.advance(400, wall_dt);
  three.engine->save();
  three.advance(400, wall_dt);
  three.engine->restore();
  const Arrays half = written(three);
  resumed.engine->read([&](const std::string& name) { return half.at(name); });
  for (ParticleRun* run : {&three, &resumed})
    for (int w = 0; w < 2; ++w) run->advance(400, wall_dt);
  const std::vector<double> expected = one.engine->wall_fields();
  EXPECT_EQ(three.engine->wall_fields(), expected) << "three threads, and a window taken back";
  EXPECT_EQ(resumed.engine->wall_fields(), expected) << "from a state file";
  ParticleRun without(falling_spheres(GetParam(), R"("variant": "generic",)", 150));
  for (int w = 0; w < 4; ++w) without.advance(400, wall_dt);
  EXPECT_EQ(dem::state_hash(without.state()), dem::state_hash(one.state())) << "they change nothing";
}

// A box with a floor of 0.125 m on which spheres come to rest.
nlohmann::json box_scene(double friction, int count) {
  PeriodicScene scene;
  scene.gravity = {0, 0, -9.81};
  scene.count = count;
  scene.axes = {};
  scene.restitution = 0.2;
  scene.friction = friction;
  nlohmann::json all = nlohmann::json::parse(scene.json());
  all["dem"]["materials"][0]["hardness"] = 2e9;
  all["dem"]["pairs"][0]["wear_coefficient"] = 1e-3;
  all["dem"]["walls"] = {{{"name", "box"},
                          {"material", "m"},
                          {"position", {0.125, 0.125, 0.0625}},
                          {"shape", {{"type", "box"}, {"size", {0.125, 0.125, 0.125}}, {"open", {"+z"}}}}}};
  all["output"]["wall_fields"] = {"box"};
  return all;
}

double mass_of(const particles::Spheres& s) {
  double mass = 0;
  for (const double r : s.radius) mass += 2500 * 4.0 / 3 * std::numbers::pi * r * r * r;
  return mass;
}

TEST(WallFields, CarryTheWeightOfABedAtRest) {
  nlohmann::json scene = box_scene(0, 120);
  auto& fill = scene["dem"]["particles"][0]["fill"];
  fill["min"] = {0.0625, 0.0625, 0}, fill["max"] = {0.1875, 0.1875, 0.125};
  ParticleRun run(scene.dump(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    for (std::size_t i = 0; i < s.size(); ++i) {  // no columns, in which nothing would press on the sides
      const auto phase = static_cast<double>(i);
      s.position[i] += 0.1 * s.radius[i] * Vec3d{std::sin(12.9 * phase), std::cos(78.2 * phase), 0};
    }
  });
  // Under a sanitizer the spheres still move a little.
  for (int w = 0; w < (sanitized ? 12 : 40); ++w) run.advance(1000, wall_dt);
  const std::vector<double> before = run.engine->wall_fields();
  run.advance(1000, wall_dt);
  const std::vector<double> after = run.engine->wall_fields();
  double on_floor = 0, on_sides = 0;
  for (std::size_t i = 0; i < after.size() / dem::wall_sum_count; ++i) {
    const std::size_t row = i * dem::wall_sum_count;
    const particles::Facet& f = run.surface.facets[i];
    const double normal = (after[row + dem::wall_normal] - before[row + dem::wall_normal]) / (1000 * wall_dt);
    (std::abs(f.normal.z) > 0.5 ? on_floor : on_sides) += normal;
  }
  const double weight = 9.81 * mass_of(run.spheres), area = 0.125 * 0.125;
  std::printf("pressure on the floor: expected %.8g Pa, measured %.8g Pa; on the sides %.3g Pa\n",
              weight / area, on_floor / area, on_sides / area);
  EXPECT_NEAR(on_floor, weight, (sanitized ? 0.1 : 1e-3) * weight);
  EXPECT_GT(on_sides, 0.05 * weight);
}

// Friction slows a sphere that begins without spin by mu g, and spins it up on the arm a to the contact: it
// slides the path v^2 / (2 mu g (1 + 5/2 (a/r)^2)) on the floor until it rolls, under its weight. Archard's
// volume is k m g times this path over the hardness, and the work of friction mu m g times it.
TEST(WallFields, WearAsArchardsLawSaysOfSpheresThatSlideUntilTheyRoll) {
  constexpr double friction = 0.4, g = 9.81, hardness = 2e9, k = 1e-3;
  nlohmann::json scene = box_scene(friction, 4);
  double arm = 0;  // over the radius [-]
  ParticleRun run(scene.dump(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    const double mass = mass_of(s) / static_cast<double>(s.size()), r = s.radius[0],
                 e_eff = 1e6 / (2 * (1 - 0.25 * 0.25));
    const double sunk = std::pow(mass * g / (4.0 / 3 * e_eff * std::sqrt(r)), 2.0 / 3);
    arm = (r - sunk) / r;
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.position[i] = {0.08, 0.08 + 0.03 * static_cast<double>(i), r - sunk};
      s.velocity[i] = {0.3 + 0.1 * static_cast<double>(i), 0, 0};
    }
  });
  for (int w = 0; w < 4; ++w) run.advance(1000, wall_dt);
  const Sums all = total(run.engine->wall_fields());
  double path = 0;
  const double mass = mass_of(run.spheres) / static_cast<double>(run.spheres.size());
  for (const Vec3d v : run.spheres.velocity) path += norm2(v) / (2 * friction * g * (1 + 2.5 * arm * arm));
  const double volume = k * mass * g * path / hardness, work = friction * mass * g * path;
  std::printf(
      "worn volume: expected %.6g m3, measured %.6g m3; work of friction: expected %.6g J, measured %.6g J\n",
      volume, all[dem::wall_wear] / hardness, work, all[dem::wall_friction_work]);
  EXPECT_NEAR(all[dem::wall_wear] / hardness, volume, 0.005 * volume);
  EXPECT_NEAR(all[dem::wall_friction_work], work, 0.005 * work);
  const double force = static_cast<double>(run.spheres.size()) * mass * g;
  EXPECT_NEAR(all[dem::wall_normal], force * 4000 * wall_dt, 1e-3 * force * 4000 * wall_dt);
}

// While a contact slides, its tangential force is mu times the elastic one: wear and work are in one ratio,
// whatever the restitution, and neither falls.
TEST(WallFields, WearAndWorkOfImpactsAreInOneRatio) {
  constexpr double friction = 0.4, k = 1e-3;
  ParticleRun run(box_scene(friction, 4).dump(), particles::Backend::cpu, 1, [](particles::Spheres& s) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.position[i] = {0.08, 0.08 + 0.03 * static_cast<double>(i), s.radius[i] + 1e-4};
      s.velocity[i] = {0.5 + 0.5 * static_cast<double>(i), 0, -0.5};
    }
  });
  double wear = 0, work = 0;
  for (int w = 0; w < 40; ++w) {
    run.advance(25, wall_dt);
    const Sums all = total(run.engine->wall_fields());
    EXPECT_GE(all[dem::wall_wear], wear);
    EXPECT_GE(all[dem::wall_friction_work], work);
    wear = all[dem::wall_wear], work = all[dem::wall_friction_work];
  }
  std::printf("wear over work: expected %.6g, measured %.6g\n", k / friction, wear / work);
  ASSERT_GT(work, 0);
  EXPECT_NEAR(wear / work, k / friction, 0.01 * k / friction);
}

}  // namespace
}  // namespace tandem::test
