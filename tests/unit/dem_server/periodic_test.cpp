// Periodic domains: what happens across a face equals what happens in the middle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "common/error.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/io/random.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/flow.hpp"
#include "tests/support/periodic_scene.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr double dt = 2e-5;  // [s]

struct Variant {
  const char *name, *options;
};
void PrintTo(const Variant& v, std::ostream* out) {
  *out << v.name;
}
class Periodic : public testing::TestWithParam<Variant> {
 protected:
  PeriodicScene scene(const json& more = json::object()) const {
    PeriodicScene s;
    s.dem = json::parse(GetParam().options);
    s.dem.update(more);
    return s;
  }
};
INSTANTIATE_TEST_SUITE_P(
    Variants, Periodic,
    testing::Values(Variant{"mixed", "{}"}, Variant{"double", R"({"precision": "double"})"},
                    Variant{"hooke_turning", R"({"contact": "hooke", "rolling": "elastic_plastic",
                            "twisting": "elastic_plastic", "pairs": [{"a": "m", "b": "m", "restitution": 0.6,
                            "friction": 0.4, "spring_stiffness": 2e3, "rolling_friction": 0.1, "rolling_damping": 0.3}]})"},
                    Variant{"frictionless", R"({"contact": "hertz_frictionless"})"}),
    [](const auto& v) { return std::string(v.param.name); });

// Two spheres about `centre` that touch, move and rotate, and both have the velocity `drift` [m/s].
auto pair_about(Vec3d centre, double gap, Vec3d velocity = {}) {
  return [=](particles::Spheres& s) {
    const double r = s.radius[0];
    const Vec3d half = {r * 0.75, r * 0.5, r * -0.375};  // exact in binary
    const Vec3d apart = (1 + gap) * half;
    s.position = {centre + apart, centre - apart};
    s.velocity = {velocity + Vec3d{-0.25, 0.125, 0.0625}, velocity + Vec3d{0.25, 0.0625, -0.125}};
    s.spin = {{10, 20, -30}, {4, -50, 6}};
  };
}
constexpr double size = 0.25, middle = size / 2;
// Corners, edges and faces.
const std::vector<Vec3d> borders = {{0, middle, middle}, {middle, 0, middle}, {middle, middle, 0},
                                    {0, 0, middle},      {size, middle, 0},   {0, 0, 0},
                                    {size, size, size}};

TEST_P(Periodic, APairAcrossAFaceHasTheBitsOfOneInside) {
  ParticleRun inside = scene().run(pair_about({middle, middle, middle}, 0));
  const auto& expected = inside.advance(1, dt);
  ASSERT_GT(expected.window.max_overlap_ratio, 0.01f);
  ASSERT_EQ(expected.end.contacts, 1u);
  for (const Vec3d at : borders)
    for (const bool exchanged : {false, true}) {  // changes which one has the lower index
      ParticleRun across = scene().run([&](particles::Spheres& s) {
        pair_about(at, 0)(s);
        for (Vec3d& x : s.position) x = particles::periods_of(*inside.scene.dem).wrapped(x);
        if (exchanged)
          for (auto* list : {&s.position, &s.velocity, &s.spin}) std::swap((*list)[0], (*list)[1]);
      });
      const auto& found = across.advance(1, dt);
      EXPECT_EQ(found.window.max_overlap_ratio, expected.window.max_overlap_ratio);
      EXPECT_EQ(found.end.contacts, 1u);
      EXPECT_EQ(found.end.kinetic_energy, expected.end.kinetic_energy);
      const particles::Spheres a = inside.state(), b = across.state();
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(b.velocity[exchanged ? 1 - i : i], a.velocity[i]) << at.x << " " << at.y << " " << at.z;
        EXPECT_EQ(b.spin[exchanged ? 1 - i : i], a.spin[i]);
      }
    }
}

// One of the two crosses a face while they are in contact, and the list is rebuilt several times: springs are
// kept.
TEST_P(Periodic, AnImpactThatCrossesFacesIsThatInside) {
  const PeriodicScene s = scene({{"skin", 0.0005}});
  const Vec3d velocity{0.5, 0.5, -0.5};
  ParticleRun inside = s.run(pair_about({middle, middle, middle}, 0.02, velocity));
  for (int w = 0; w < 80; ++w) inside.advance(20, dt);
  EXPECT_GT(inside.advance(1, dt).window.rebuilds, 20u);
  EXPECT_EQ(inside.advance(1, dt).end.contacts, 0u);
  const particles::Spheres a = inside.state();
  const double tolerance = std::string(GetParam().name) == "double" ? 1e-10 : 1e-5;
  double worst_v = 0, worst_w = 0;
  for (const Vec3d border : borders) {
    ParticleRun across = s.run([&](particles::Spheres& spheres) {
      // The first one crosses after one millimetre.
      pair_about(border, 0.02, velocity)(spheres);
      const Vec3d off = Vec3d{-0.001, -0.001, 0.001} + border - spheres.position[0];
      for (Vec3d& x : spheres.position) x += off;
    });
    int before = 0, after = 0;  // windows with contact before the first one has crossed, and after
    const particles::Periods periods = particles::periods_of(*across.scene.dem);
    for (int w = 0; w < 80; ++w) {
      const dem::WindowOutcome& o = across.advance(20, dt);
      const bool touching = o.end.contacts == 1;
      EXPECT_EQ(o.window.lost, 0u);
      const particles::Spheres now = across.state();
      ASSERT_EQ(now.size(), 2u);
      for (const Vec3d& x : now.position) EXPECT_EQ(periods.wrapped(x), x) << "seen in the domain";
      const Vec3d from = periods.shortest(now.position[0] - border);
      const bool crossed = (border.x != middle ? from.x > 0 : border.y != middle ? from.y > 0 : from.z < 0);
      if (touching) ++(crossed ? after : before);
    }
    EXPECT_GT(before, 1);
    EXPECT_GT(after, 1);
    across.advance(1, dt);
    across.advance(1, dt);
    const particles::Spheres b = across.state();
    for (std::size_t i = 0; i < 2; ++i) {
      worst_v = std::max(worst_v, norm(b.velocity[i] - a.velocity[i]) / norm(a.velocity[i]));
      worst_w = std::max(worst_w, norm(b.spin[i] - a.spin[i]) / norm(a.spin[i]));
    }
  }
  std::printf("  velocities off by at most %.1e, spins by %.1e, tolerance %.0e\n", worst_v, worst_w,
              tolerance);
  EXPECT_LT(worst_v, tolerance);
  EXPECT_LT(worst_w, tolerance);
}

// Slides until it rolls.
TEST(PeriodicWall, ASphereSlidesIntoRollingAcrossFacesAsInAWideDomain) {
  PeriodicScene narrow;
  narrow.dem = {{"precision", "double"}, {"walls", floor_at(0.125)}, {"skin", 0.001}};
  narrow.gravity = {0, 0, -9.81};
  narrow.count = 1;
  narrow.axes = {"x", "y"};
  PeriodicScene wide = narrow;
  wide.axes = {};
  wide.dem["domain"] = {{"min", {0, 0, 0}}, {"max", {1, 1, 0.25}}};
  const auto start = [](particles::Spheres& s) {
    s.position[0] = {0.1, 0.2, 0.125 + s.radius[0] * (1 - 1e-4)};
    s.velocity[0] = {1.0, 0.5, 0};
  };
  ParticleRun a = narrow.run(start), b = wide.run(start);
  for (int w = 0; w < 40; ++w) {
    EXPECT_EQ(a.advance(500, dt).window.lost, 0u);
    b.advance(500, dt);
  }
  const particles::Spheres in_narrow = a.state(), in_wide = b.state();
  std::printf("  speed expected %.12g measured %.12g m/s; went %.3g m\n", in_wide.velocity[0].x,
              in_narrow.velocity[0].x, in_wide.position[0].x - 0.1);
  EXPECT_NEAR(in_narrow.velocity[0].x, 5.0 / 7, 0.01) << "it rolls";
  EXPECT_LT(norm(in_narrow.velocity[0] - in_wide.velocity[0]), 1e-9);
  EXPECT_LT(norm(in_narrow.spin[0] - in_wide.spin[0]), 1e-7);
  const Vec3d off = particles::periods_of(*a.scene.dem).shortest(in_narrow.position[0] - in_wide.position[0]);
  EXPECT_LT(norm(off), 1e-9);
}

// Hertz's energy of two equal spheres: 8/15 E* sqrt(R/2) delta^2.5.
double stored_energy(const ParticleRun& run, const particles::Spheres& s) {
  const particles::Periods periods = particles::periods_of(*run.scene.dem);
  const scene::Material& m = run.scene.dem->materials[0];
  const double e_star = m.young / (2 * (1 - m.poisson * m.poisson));
  double sum = 0;
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double overlap =
          s.radius[i] + s.radius[j] - norm(periods.shortest(s.position[i] - s.position[j]));
      if (overlap > 0) sum += 8.0 / 15 * e_star * std::sqrt(s.radius[i] / 2) * std::pow(overlap, 2.5);
    }
  return sum;
}

class Gas : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Precisions, Gas, testing::Values("mixed", "double"),
                         [](const auto& p) { return std::string(p.param); });

TEST_P(Gas, KeepsMomentumAndEnergyInAllThreeDirections) {
  PeriodicScene scene;
  scene.count = 150;
  scene.size = 0.125;
  scene.restitution = 1;
  scene.friction = 0;
  scene.dem = {{"precision", GetParam()}, {"contact", "hertz_frictionless"}};
  particles::Random random(5);
  ParticleRun run = scene.run([&](particles::Spheres& s) {
    for (Vec3d& v : s.velocity) v = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.5, 1.5)};
  });
  Vec3d first;
  double energy = 0, scale = 0;
  constexpr int windows = 40;
  std::uint64_t contacts = 0;
  for (int w = 0; w < windows; ++w) {
    // Leapfrog's velocities are half a step behind; a small dt keeps the error of the energy, of first order
    // in dt, small.
    const auto& o = run.advance(500, 2e-6);
    contacts += o.end.contacts;
    if (w == 0) {
      first = o.begin.momentum;
      energy = o.begin.kinetic_energy;
      scale = std::sqrt(2 * energy * o.begin.mass);
    }
    EXPECT_EQ(o.window.lost, 0u);
    EXPECT_LT(norm(o.end.momentum - first), 1e-12 * scale);
    if (w + 1 < windows) continue;
    const double end = o.end.kinetic_energy + stored_energy(run, run.state());
    std::printf("  %llu contacts seen; momentum off by %.1e of %.3g; energy expected %.8g measured %.8g J\n",
                static_cast<unsigned long long>(contacts), norm(o.end.momentum - first), scale, energy, end);
    EXPECT_NEAR(end, energy, 1e-3 * energy);
  }
  EXPECT_GT(contacts, 200u);
}

TEST(PeriodicBed, WeighsWhatItWeighs) {
  // Thrown sideways, the bed slides and shears until friction has stopped it.
  ParticleRun run = bed().run([](particles::Spheres& s) {
    for (std::size_t i = 0; i < s.size(); ++i) s.velocity[i] = {0.3 + s.position[i].z, -0.2, 0};
  });
  double mean = 0, side = 0, mass = 0;
  Vec3d momentum, recorded;
  for (int w = 0; w < 100; ++w) {
    const auto& o = run.advance(500, dt);
    if (w == 0) momentum = o.begin.momentum;
    mass = o.end.mass;
    EXPECT_EQ(o.window.lost, 0u);
    for (const Wrench& l : o.load) recorded += -dt * l.force;
    recorded += o.gravity_impulse;
    EXPECT_LT(norm(o.end.momentum - momentum - recorded), 1e-11 * mass * 1.0) << "[m/s]";
    if (w < 90) continue;
    for (const Wrench& l : o.load) {
      mean -= l.force.z / (10 * 500);
      side += std::hypot(l.force.x, l.force.y) / (10 * 500);
    }
  }
  const double expected = mass * 9.81;
  std::printf("  weight expected %.8g measured %.8g N, sideways %.2g N\n", expected, mean, side);
  EXPECT_NEAR(mass, 200 * 4.0 / 3 * std::numbers::pi * 2500 * std::pow(run.spheres.radius[0], 3),
              1e-6 * mass);
  EXPECT_NEAR(mean, expected, 1e-4 * expected);
  EXPECT_LT(side, 1e-2 * expected);
}

std::string hash_after(ParticleRun& run, int windows) {
  for (int w = 0; w < windows; ++w) run.advance(300, dt);
  return dem::state_hash(run.state());
}
const auto left_alone = [](particles::Spheres&) {};

TEST_P(Periodic, ThreadsAndWindowsDoNotChangeTheBits) {
  ParticleRun one = chute(json::parse(GetParam().options)).run(left_alone),
              three = chute(json::parse(GetParam().options)).run(left_alone, 3),
              shorter = chute(json::parse(GetParam().options)).run(left_alone);
  const std::string hash = hash_after(one, 15);
  EXPECT_EQ(hash_after(three, 15), hash);
  for (int w = 0; w < 45; ++w) shorter.advance(100, dt);
  EXPECT_EQ(dem::state_hash(shorter.state()), hash);
  EXPECT_GT(one.advance(1, dt).end.contacts, 80u);
}

using Arrays = std::map<std::string, std::vector<std::byte>>;
Arrays written(ParticleRun& run) {
  Arrays arrays;
  run.engine->write([&](const std::string& name, std::span<const std::byte> bytes) {
    arrays.emplace(name, std::vector(bytes.begin(), bytes.end()));
  });
  return arrays;
}

TEST_P(Periodic, SavedAndWrittenRunsGoOnToTheSameBits) {
  ParticleRun run = chute(json::parse(GetParam().options)).run(left_alone);
  hash_after(run, 10);
  const Arrays arrays = written(run);
  run.engine->save();
  const std::string end = hash_after(run, 4);
  run.engine->restore();
  EXPECT_EQ(hash_after(run, 4), end);
  ParticleRun fresh = chute(json::parse(GetParam().options)).run(left_alone, 2);
  fresh.engine->read([&](const std::string& name) { return arrays.at(name); });
  EXPECT_EQ(written(fresh), arrays);
  EXPECT_EQ(hash_after(fresh, 4), end);

  PeriodicScene without = chute(json::parse(GetParam().options));
  without.axes = {};
  without.dem["variant"] = "generic";
  ParticleRun other = without.run(left_alone);
  EXPECT_THROW(other.engine->read([&](const std::string& name) { return arrays.at(name); }), Error);
}

TEST_P(Periodic, MemoryIsKnownBefore) {
  ParticleRun run = chute(json::parse(GetParam().options)).run(left_alone);
  const dem::EngineChoice choice = dem::choose_engine(run.scene, particles::Backend::cpu);
  EXPECT_THAT(choice.variant, HasSubstr("generic"));
  EXPECT_TRUE(choice.generic_fallback);
  dem::EngineSetup setup{run.scene, run.surface, run.spheres, run.skins, 1};
  setup.neighbours = particles::most_neighbours(run.skins);
  setup.contacts = particles::most_contacts;
  setup.walls = particles::most_walls;
  EXPECT_EQ(dem::predicted_bytes(choice, setup, false), dem::make_engine(choice, setup)->memory_bytes());
}

// ---- seen through the solver

TEST(PeriodicDomain, OfFewerThanThreeCellsIsRefused) {
  const auto domain = [](double x) {
    return shower({{"rate", 10}, {"min", {0, 0, 0.4}}, {"max", {0.05, 0.05, 0.5}}},
                  {{"skin", 0.005},
                   {"domain", {{"min", {0, 0, 0}}, {"max", {x, 0.08, 0.5}}, {"periodic", {"x", "y"}}}}});
  };
  EXPECT_EQ(error_of([&] { Rain{domain(0.0751)}; }), "no error");
  EXPECT_EQ(error_of([&] { Rain{domain(0.07)}; }),
            "scene: dem.domain: the domain is 0.07 m long along the periodic axis x (give it at least 0.075 "
            "m: three "
            "times the largest diameter and the skin of the neighbour list)");
}

TEST(PeriodicDomain, InletsFindRoomAcrossFaces) {
  // Half spheres of the inlet's width are at both faces of x: there is room for one sphere at a time.
  json scene =
      shower({{"rate", 1000}, {"count", 40}, {"min", {0, 0, 0.4}}, {"max", {0.08, 0.08, 0.43}}},
             {{"domain", {{"min", {0, 0, 0}}, {"max", {0.08, 0.08, 0.5}}, {"periodic", {"x", "y"}}}}});
  Rain rain(scene);
  rain.advance(400);
  EXPECT_EQ(rain.report()["came_in"], 40);
  EXPECT_EQ(rain.report()["contacts"], 0);
  EXPECT_EQ(rain.report()["max_speed"], 1) << "none was put on another";
}

TEST(PeriodicDomain, OutletsTakeWhereSpheresAreSeen) {
  json box = {{{"name", "half"}, {"region", {{"type", "box"}, {"min", {0, -1, -1}}, {"max", {0.02, 1, 1}}}}}};
  json scene = shower({{"rate", 300}, {"min", {0.06, 0.02, 0.4}}, {"max", {0.1, 0.1, 0.5}}},
                      {{"outlets", box},
                       {"domain", {{"min", {0, 0, 0}}, {"max", {0.1, 0.1, 0.5}}, {"periodic", {"x", "z"}}}}});
  scene["dem"]["particles"][0]["velocity"] = {2, 0, -0.1};
  Rain rain(scene);
  rain.advance(400);
  const protocol::ParticlesFrame& f = rain.frame();
  for (std::size_t i = 0; i < f.id.size(); ++i) {
    EXPECT_GE(f.position[3 * i], 0);
    EXPECT_LT(f.position[3 * i], 0.1);
  }
  EXPECT_GT(rain.report()["went_out"], 90);
  EXPECT_EQ(rain.lost, 0u);
  EXPECT_LT(norm(rain.open), 1e-12 * rain.exchanged);
}

}  // namespace
}  // namespace tandem::test
