// Conveyor belts: a sphere that is dropped on a belt, compared with closed forms.
//
// Coulomb's force m g mu accelerates the sphere until its lowest point has the velocity V of the belt. If the
// sphere cannot rotate, that is after t = V / (mu g). A sphere that can rotate gains v = mu g t and at its
// lowest point another R w = 5/2 mu g t: the slip ends after t = 2/7 V / (mu g) with v = 2/7 V, and then the
// sphere rolls. The drive does the work F V t, of which half becomes kinetic energy in both cases.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "dem_server/coupling/belts.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"
#include "tests/verification/dem/impact.hpp"

namespace tandem::test {
namespace belt_test {

constexpr double R = 0.01, g = 9.81, V = 0.5, mu = 0.3, dt = 1e-5;
constexpr std::uint32_t at_once = 50;
constexpr Ball ball{1e8, 0.3, 2500, 0.2, mu, R};

struct BeltRun {
  nlohmann::json scene;
  Vec3d along{1, 0, 0}, normal{0, 0, 1};

  BeltRun(const Variant& variant, const nlohmann::json& velocity) {
    nlohmann::json wall = nlohmann::json::parse(rigid_plane);
    wall["surface_velocity"] = velocity;
    scene = nlohmann::json::parse(impact_scene(variant, ball, 1, wall.dump()));
    scene["gravity"] = {0, 0, -g};
    scene["dem"]["domain"] = {{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}};
  }
  // Moves belt, gravity and sphere with a rotation, the belt on a body whose frame is rotated.
  void rotate(Quat q) {
    along = q.rotate(along), normal = q.rotate(normal);
    const Vec3d down = -g * normal;
    scene["gravity"] = {down.x, down.y, down.z};
    scene["coupling"] = {{"window", 1e-3}};
    scene["mbd"]["bodies"] = {{{"name", "frame"},
                               {"mass", 1},
                               {"inertia", {1, 1, 1, 0, 0, 0}},
                               {"position", {0, 0, 0}},
                               {"orientation", {q.w, q.x, q.y, q.z}}}};
    scene["dem"]["walls"][0]["body"] = "frame";
  }
};

struct Seen {
  double slipped = 0;  // time at which the slip ended [s]
  Vec3d velocity, spin;
  double work = 0;  // of the drive [J]
};

// The sphere starts at rest where the belt carries its weight. The slip ends when its velocity stays.
Seen run_belt(const BeltRun& belt, double end) {
  const double depth = std::pow(ball.mass() * g / ball.stiffness_on_plane(), 2.0 / 3);
  ParticleRun run(belt.scene.dump(), tested_backend(), 1, [&](particles::Spheres& s) {
    s.position = {(R - depth) * belt.normal};
    s.velocity = {{0, 0, 0}};
  });
  dem::Belts belts(run.scene, run.surface);
  std::vector<dem::Belts::Record> records = belts.no_records();
  Seen result;
  double last = 0;
  for (double time = 0; time < end; time += at_once * dt) {
    std::vector<particles::PreparedPath> paths;
    for (const BodyId body : run.surface.boundary_bodies) {
      const Pose pose = body == ground ? Pose{} : run.scene.mbd->bodies[body.value].pose;
      paths.push_back(particles::prepare_path({pose, pose, {}, {}}, at_once * dt));
    }
    dem::WindowPlan plan{at_once, dt, paths, 0, 0};
    plan.belt_velocity = belts.velocities(time, at_once, dt);
    belts.record(run.engine->advance(plan), plan, records);
    const particles::Spheres now = run.state();
    result.velocity = now.velocity.at(0), result.spin = now.spin.at(0);
    const double speed = dot(result.velocity, belt.along), gained = mu * g * at_once * dt;
    // Within the interval in which the slip ends the sphere gains only a part of this.
    if (result.slipped == 0 && speed - last < 0.99 * gained && time > 0)
      result.slipped = time + (speed - last) / (mu * g);
    last = speed;
  }
  result.work = records.at(0).work;
  return result;
}

const Variant rolls{"hertz_mindlin", "hertz_mindlin", "", true};
const Variant rolls_in_double{"generic_double", "hertz_mindlin", R"("precision": "double",)", true};
const Variant stays_upright{"no rotation", "hertz_mindlin", R"("rolling": "elastic_plastic",)", true,
                            R"("rolling_friction": 1, "rolling_damping": 0.3)"};

void expect_rolling(const Variant& variant, const BeltRun& belt, double V_end, const char* what) {
  const Seen seen = run_belt(belt, 0.1);
  const double m = ball.mass(), t = 2.0 / 7 * V / (mu * g);
  const std::string of = what;
  expect_row(variant, of + ": end of the slip [s]", seen.slipped, t, 5e-3);
  expect_row(variant, of + ": velocity [m/s]", dot(seen.velocity, belt.along), 2.0 / 7 * V_end, 1e-3);
  expect_row(variant, of + ": R w [m/s]", R * norm(seen.spin), 5.0 / 7 * V_end, 1e-3);
  expect_row(variant, of + ": work of the drive [J]", seen.work, 2.0 / 7 * m * V * V, 3e-3);
}

TEST(Belt, SphereRollsAfterTwoSeventhsOfTheTime) {
  for (const Variant& variant : {rolls, rolls_in_double})
    expect_rolling(variant, BeltRun(variant, {V, 0, 0}), V, "on the ground");
}

TEST(Belt, SphereThatCannotRotateReachesTheSpeedOfTheBelt) {
  const Seen seen = run_belt(BeltRun(stays_upright, {V, 0, 0}), 0.25);
  const double m = ball.mass();
  expect_row(stays_upright, "end of the slip [s]", seen.slipped, V / (mu * g), 5e-3);
  expect_row(stays_upright, "velocity [m/s]", seen.velocity.x, V, 1e-3);
  expect_row(stays_upright, "work of the drive [J]", seen.work, m * V * V, 3e-3);
}

TEST(Belt, MovesWithItsBody) {
  BeltRun belt(rolls_in_double, {V, 0, 0});
  belt.rotate(Quat{0.3, -0.5, 0.7, 0.4}.normalized());
  expect_rolling(rolls_in_double, belt, V, "on a rotated body");
}

TEST(Belt, GenericVariantGivesTheSameBits) {
  const Variant generic{"generic", "hertz_mindlin", R"("variant": "generic",)", true};
  const Seen special = run_belt(BeltRun(rolls, {V, 0, 0}), 0.1),
             same = run_belt(BeltRun(generic, {V, 0, 0}), 0.1);
  EXPECT_EQ(special.velocity, same.velocity);
  EXPECT_EQ(special.spin, same.spin);
  EXPECT_EQ(special.work, same.work);
}

// Most variants contain no belts: they would ignore one.
TEST(Belt, RunsOnAVariantWithBelts) {
  const auto variant_of = [](const char* law, double speed) {
    nlohmann::json scene = BeltRun({"", law, "", true}, {V, 0, 0}).scene;
    if (speed == 0) scene["dem"]["walls"][0].erase("surface_velocity");
    return dem::choose_engine(scene::parse(scene.dump(), "test"), particles::Backend::cpu).variant;
  };
  EXPECT_EQ(variant_of("hertz_mindlin", V), "hertz_mindlin_belts");
  EXPECT_EQ(variant_of("hertz_mindlin", 0), "hertz_mindlin");
  EXPECT_EQ(variant_of("paper", V), "generic");
  EXPECT_EQ(variant_of("paper", 0), "paper");

  const ParticleRun run(BeltRun(rolls, {V, 0, 0}).scene.dump());
  dem::EngineChoice other;
  other.variant = "hertz_mindlin";
  EXPECT_THROW(dem::make_engine(other, {run.scene, run.surface, run.spheres, run.skins, 1}), Error);
}

TEST(Belt, FollowsAFunctionOfTime) {
  // A belt that speeds up more slowly than friction could carries the sphere along: it rolls from the start,
  // with 2/7 of the belt's velocity.
  const nlohmann::json ramp = {{"direction", {1, 0, 0}},
                               {"speed", {{"type", "ramp"}, {"to", V}, {"duration", 0.2}}}};
  const Seen seen = run_belt(BeltRun(rolls, ramp), 0.3);
  expect_row(rolls, "after a ramp: velocity [m/s]", seen.velocity.x, 2.0 / 7 * V, 2e-3);
  expect_row(rolls, "after a ramp: work of the drive [J]", seen.work, 2.0 / 7 * ball.mass() * V * V / 2,
             5e-3);
}

// At rest on the rim of a belt that ends there, the sphere feels no push along the velocity: the end face
// stands still.
TEST(Belt, EndFaceDoesNotPush) {
  nlohmann::json wall = {{"name", "belt"},
                         {"material", "rigid"},
                         {"position", {-0.1, 0, 0}},
                         {"shape", {{"type", "box"}, {"size", {0.2, 0.2, 0.2}}}},
                         {"surface_velocity", {V, 0, 0}}};
  nlohmann::json scene = nlohmann::json::parse(impact_scene(rolls, ball, 1, wall.dump()));
  // It touches the end face x = 0 from outside, without overlap, in weightlessness.
  ParticleRun run(scene.dump(), tested_backend(), 1, [&](particles::Spheres& s) {
    s.position = {{R * (1 - 1e-6), 0, 0}};
    s.velocity = {{0, 0, 0}};
  });
  dem::Belts belts(run.scene, run.surface);
  std::vector<particles::PreparedPath> paths(run.surface.boundary_bodies.size(),
                                             particles::prepare_path({}, at_once * dt));
  dem::WindowPlan plan{at_once, dt, paths, 0, 0};
  plan.belt_velocity = belts.velocities(0, at_once, dt);
  run.engine->advance(plan);
  const double speed = run.state().velocity.at(0).x;
  std::printf("  end face: expected a rebound below 1e-3 m/s, measured %.3g m/s\n", speed);
  EXPECT_LT(speed, 1e-3);
  EXPECT_GE(speed, 0);
}

}  // namespace belt_test
}  // namespace tandem::test
