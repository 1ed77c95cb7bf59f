// The energy that contacts dissipate, from the forces of their dampers, friction and rolling resistance,
// against what the spheres lose.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "dem_server/contact/dissipation.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_scenes.hpp"
#include "tests/support/periodic_scene.hpp"

namespace tandem::test {
namespace {

constexpr double impact_dt = 2e-5;  // [s]

std::string with_dissipation(const std::string& scene) {
  nlohmann::json all = nlohmann::json::parse(scene);
  all["output"]["dissipation"] = true;
  return all.dump();
}

double sum(const std::vector<double>& energy) {
  EXPECT_EQ(energy.size(), std::size_t{dem::dissipation_count});
  double all = 0;
  for (const double part : energy) all += part;
  return all;
}

// Of translation and rotation, and of gravity over z = 0, of spheres of density 2500 kg/m3 [J].
double energy_of(const particles::Spheres& s, double g) {
  double energy = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double r = s.radius[i], mass = 2500 * 4.0 / 3 * std::numbers::pi * r * r * r;
    energy += mass * (0.5 * norm2(s.velocity[i]) + 0.2 * r * r * norm2(s.spin[i]) + g * s.position[i].z);
  }
  return energy;
}

class Dissipated : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Laws, Dissipated, testing::Values("hertz_mindlin", "hertz_frictionless", "hooke"));

// Two spheres that meet, and one that meets a wall, at an angle.
TEST_P(Dissipated, InImpacts) {
  PeriodicScene scene = bed(nlohmann::json::parse(
      std::string(R"({"contact": ")") + GetParam() +
      R"(", "pairs": [{"a": "m", "b": "m", "restitution": 0.5, "friction": 0.3, "spring_stiffness": 2000}]})"));
  scene.gravity = {};
  scene.count = 3;
  ParticleRun run(with_dissipation(scene.json()), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    const double r = s.radius[0];
    s.position = {{0.02, 0.06, 0.06}, {0.02 + 2.01 * r, 0.06, 0.063}, {0.08, 0.06, 1.01 * r}};
    s.velocity = {{0.4, 0.2, 0}, {-0.3, 0, 0}, {0.3, 0.1, -0.4}};
  });
  const double before = energy_of(run.state(), 0);
  for (int w = 0; w < 4; ++w) run.advance(500, impact_dt);
  const double lost = before - energy_of(run.state(), 0);
  const std::vector<double> parts = run.engine->dissipated();
  std::printf("%s: lost %.6g J, dissipated %.6g J (damping %.3g, friction %.3g)\n", GetParam(), lost,
              sum(parts), parts[dem::by_normal_damping], parts[dem::by_friction]);
  EXPECT_GT(lost, 0.2 * before);
  EXPECT_NEAR(sum(parts), lost, 2e-3 * lost);
  EXPECT_EQ(parts[dem::by_friction] > 0, std::string(GetParam()) != "hertz_frictionless");
}

// Spheres fall into a box and come nearly to rest, with rolling resistance.
TEST_P(Dissipated, WhereManySpheresFall) {
  PeriodicScene scene;
  scene.gravity = {0, 0, -9.81};
  scene.count = 120;
  scene.axes = {};
  nlohmann::json all = nlohmann::json::parse(scene.json());
  all["dem"]["contact"] = GetParam();
  all["dem"]["rolling"] = "elastic_plastic";
  all["dem"]["pairs"][0].update(
      {{"spring_stiffness", 2000}, {"rolling_friction", 0.1}, {"rolling_damping", 0.3}});
  auto& group = all["dem"]["particles"][0];
  group["velocity"] = {0.3, 0.1, -1};
  group["fill"]["min"] = {0.0625, 0.0625, 0.02}, group["fill"]["max"] = {0.1875, 0.1875, 0.2};
  all["dem"]["walls"] = {{{"name", "box"},
                          {"material", "m"},
                          {"position", {0.125, 0.125, 0.125}},
                          {"shape", {{"type", "box"}, {"size", {0.125, 0.125, 0.25}}, {"open", {"+z"}}}}}};
  ParticleRun run(with_dissipation(all.dump())), without(all.dump()),
      three(with_dissipation(all.dump()), particles::Backend::cpu, 3);
  constexpr double g = 9.81;
  const double before = energy_of(run.state(), g);
  constexpr int windows = sanitized ? 12 : 40;
  std::vector<double> early;
  for (int w = 0; w < windows; ++w) {
    run.advance(500, impact_dt);
    if (w == 4) early = run.engine->dissipated();
  }
  const double lost = before - energy_of(run.state(), g);
  const std::vector<double> parts = run.engine->dissipated();
  std::printf(
      "%s: expected %.6g J, measured %.6g J, tolerance 1 %% (damping %.3g, friction %.3g, rolling %.3g)\n",
      GetParam(), lost, sum(parts), parts[dem::by_normal_damping], parts[dem::by_friction],
      parts[dem::by_rolling]);
  EXPECT_GT(lost, 0.2 * before);
  EXPECT_NEAR(sum(parts), lost, (sanitized ? 0.03 : 0.01) * lost);  // springs still store some
  if (std::string(GetParam()) != "hertz_mindlin") return;
  EXPECT_GT(parts[dem::by_rolling], 0);
  for (int w = 0; w < windows; ++w) without.advance(500, impact_dt);
  for (int w = 0; w < 5; ++w) three.advance(500, impact_dt);
  EXPECT_EQ(three.engine->dissipated(), early) << "the same bits with three threads";
  EXPECT_EQ(dem::state_hash(without.state()), dem::state_hash(run.state())) << "it changes nothing";
}

}  // namespace
}  // namespace tandem::test
