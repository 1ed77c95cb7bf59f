// A particle participant against the scene, its frames against its account.
#include "coordinator/watch/particle_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "common/error.hpp"
#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

using protocol::ParticlesFrame;
using ::testing::HasSubstr;

// Two spheres of 1 cm at (-0.1, 0, 0) and (0.1, 0, 0), which fly upwards with 2 m/s.
SceneFile two_spheres(const std::string& of_dem = "", const std::string& velocity = "[0, 0, 2]",
                      const std::string& gravity = "[0, 0, -10]") {
  SceneFile file;
  file.text = R"({
    "tandem": "1.1", "name": "two", "end_time": 1, "gravity": )" +
              gravity + R"(, "coupling": {"window": 0.01},
    "dem": {
      "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
      "particles": [{"name": "pair", "material": "glass", "radius": 0.01, "velocity": )" +
              velocity + R"(,
                     "fill": {"type": "lattice", "min": [-0.11, -0.01, -0.01], "max": [0.111, 0.011, 0.011], "spacing": 0.2}}],
      "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -5], "normal": [0, 0, 1]}}],
      )" + of_dem +
              R"("domain": {"min": [-1, -1, -6], "max": [1, 1, 6]}}
  })";
  file.scene = scene::parse(file.text, "two.json");
  return file;
}

const double sphere_kg = 2500 * 4.0 / 3 * std::numbers::pi * 1e-6;  // of one sphere [kg]
constexpr double flight_H = 0.01, flight_g = 10;

// Window `index` of the flight.
Exchange flight_window(int index) {
  Exchange exchange;
  exchange.load.window = {static_cast<std::uint64_t>(index), Nanoseconds{index * 10'000'000},
                          Nanoseconds{(index + 1) * 10'000'000}};
  exchange.path.window = exchange.load.window;
  protocol::ParticleAccount& a = exchange.load.account;
  a.micro_steps = 1000;
  a.micro_step = flight_H / 1000;
  a.momentum_begin.z = 2 * sphere_kg * (2 - flight_g * flight_H * index);
  a.momentum_end.z = 2 * sphere_kg * (2 - flight_g * flight_H * (index + 1));
  a.gravity_impulse.z = -2 * sphere_kg * flight_g * flight_H;
  a.kinetic_energy = sphere_kg * std::pow(2 - flight_g * flight_H * (index + 1), 2);
  return exchange;
}

ParticlesFrame flight_frame(int windows) {
  ParticlesFrame frame;
  frame.time = Nanoseconds{windows * 10'000'000};
  const double t = flight_H * windows;
  frame.id = {0, 1};
  for (const double x : {-0.1, 0.1}) {
    frame.position.insert(frame.position.end(), {x, 0, 2 * t - 0.5 * flight_g * t * t});
    frame.velocity.insert(frame.velocity.end(), {0, 0, static_cast<float>(2 - flight_g * t)});
    frame.spin.insert(frame.spin.end(), {0, 0, 0});
    frame.radius.push_back(0.01f);
  }
  return frame;
}

template <class Call>
std::string refusal_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol);
    return error.problem();
  }
  return "none";
}

// A flight of ten windows with a frame after five of them, and one at the end.
template <class Spoil>
ParticleWatch flown(Spoil spoil) {
  ParticleWatch watch(two_spheres());
  watch.observe(flight_frame(0));
  for (int i = 0; i < 10; ++i) {
    watch.record(flight_window(i));
    if (i != 4 && i != 9) continue;
    ParticlesFrame seen = flight_frame(i + 1);
    spoil(seen);
    watch.observe(seen);
  }
  return watch;
}

TEST(ParticleWatch, KnowsTheSpheresOfTheScene) {
  const SceneSpheres spheres = spheres_of(two_spheres());
  EXPECT_EQ(spheres.at_start, 2u);
  EXPECT_EQ(spheres.in_all, 2u);
  EXPECT_NEAR(spheres.mass, 2 * sphere_kg, 1e-15);
  EXPECT_EQ(spheres.mass_spread, 0);
  EXPECT_NEAR(spheres.momentum.z, 4 * sphere_kg, 1e-15);
  EXPECT_EQ(spheres.group_of(1).name, "pair");
  EXPECT_GT(spheres.critical_time, 1e-5);
  EXPECT_LT(spheres.critical_time, 1e-2);
}

TEST(ParticleWatch, AFlightIsSilent) {
  const ParticleWatch watch = flown([](ParticlesFrame&) {});
  EXPECT_TRUE(watch.compared());
  for (const FalseSpheres& found : watch.false_spheres()) EXPECT_EQ(found.spheres, 0u) << found.example;
  for (const FrameDifference& d : watch.differences()) EXPECT_LT(d.share, 1e-6) << d.values;
  EXPECT_FALSE(watch.angular_momentum_balance()) << "nothing loads a wall";
}

TEST(ParticleWatch, RefusesAnotherStart) {
  ParticleWatch watch(two_spheres());
  ParticlesFrame start = flight_frame(0);
  start.position[3] += 0.001;
  EXPECT_EQ(refusal_of([&] { watch.observe(start); }),
            "sphere 1 of 'pair' starts at (0.101, 0, 0) m, and the scene has it at (0.1, 0, 0) m");
  ParticleWatch again(two_spheres());
  start = flight_frame(0);
  start.velocity[2] = 0;
  EXPECT_EQ(
      refusal_of([&] { again.observe(start); }),
      "sphere 0 of 'pair' starts with the velocity (0, 0, 0) m/s, and the scene gives it (0, 0, 2) m/s");
  Exchange first = flight_window(0);
  first.load.account.momentum_begin.z *= 1.001;
  EXPECT_THAT(refusal_of([&] { again.record(first); }), HasSubstr("the particles start with the momentum"));
  first = flight_window(0);
  first.load.account.gravity_impulse.z *= 1.01;
  EXPECT_THAT(refusal_of([&] { again.record(first); }), HasSubstr("whose mass is 0.0209"));
}

TEST(ParticleWatch, RefusesAnImpossibleAccount) {
  ParticleWatch watch(two_spheres());
  Exchange exchange = flight_window(0);
  exchange.load.account.lost_particles = 3;
  EXPECT_EQ(refusal_of([&] { watch.record(exchange); }),
            "the account has 3 lost particles, and the scene 2 spheres");
  exchange.load.account.lost_particles = 1;
  watch.record(exchange);
  EXPECT_EQ(refusal_of([&] { watch.record(flight_window(1)); }),
            "the account has 0 lost particles since the start, after 1 in the window before");
  ParticleWatch fine(two_spheres(R"("micro_step": 1e-5, )"));
  EXPECT_EQ(refusal_of([&] { fine.record(flight_window(0)); }), "none");
  exchange = flight_window(1);
  exchange.load.account.micro_steps = 1;
  exchange.load.account.micro_step = flight_H;
  EXPECT_EQ(refusal_of([&] { fine.record(exchange); }),
            "the account has micro steps of 0.01 s, and dem.micro_step of the scene is 1e-05 s");
}

TEST(ParticleWatch, CountsFalseSpheres) {
  const ParticleWatch fewer = flown([](ParticlesFrame& seen) {
    seen.id.pop_back();
    seen.radius.pop_back();
    seen.position.resize(3);
    seen.velocity.resize(3);
    seen.spin.resize(3);
  });
  EXPECT_EQ(fewer.false_spheres()[0].spheres, 1u);
  EXPECT_EQ(fewer.false_spheres()[0].example, "it has 1 spheres, and 2 of the scene's spheres remain");
  const ParticleWatch larger = flown([](ParticlesFrame& seen) { seen.radius[1] = 0.02f; });
  EXPECT_EQ(larger.false_spheres()[1].spheres, 1u);
  EXPECT_THAT(larger.false_spheres()[1].example,
              HasSubstr("sphere 1 has the radius 0.02 m, and its group 'pair'"));
  const ParticleWatch unknown = flown([](ParticlesFrame& seen) { seen.id[1] = 7; });
  EXPECT_THAT(unknown.false_spheres()[1].example, HasSubstr("sphere 7 is none of the scene"));
  const ParticleWatch outside = flown([](ParticlesFrame& seen) { seen.position[0] = 1e200; });
  EXPECT_EQ(outside.false_spheres()[2].spheres, 1u);
  EXPECT_THAT(outside.false_spheres()[2].example, HasSubstr("sphere 0 is at (1e+200, 0, "));
}

TEST(ParticleWatch, ComparesFramesWithTheAccount) {
  const ParticleWatch slower = flown([](ParticlesFrame& seen) { seen.velocity[2] *= 0.99f; });
  EXPECT_NEAR(slower.differences()[0].share, 0.005, 1e-4);
  EXPECT_NEAR(slower.differences()[1].share, 0.01, 1e-4);
  const ParticleWatch spinning = flown([](ParticlesFrame& seen) { seen.spin[0] = 1000; });
  EXPECT_LT(spinning.differences()[0].share, 1e-6);
  EXPECT_GT(spinning.differences()[1].share, 0.1);
  const ParticleWatch elsewhere = flown([](ParticlesFrame& seen) {
    for (const std::size_t x : {0u, 3u}) seen.position[x] += 0.1;
  });
  EXPECT_LT(elsewhere.differences()[0].share, 1e-6);
  // Less what the momentum inside the windows leaves open: half of 0.5 m/s for 10 ms.
  EXPECT_NEAR(elsewhere.differences()[2].share, (0.1 - 0.0025) / std::hypot(2, 2, 12), 1e-6);
}

TEST(ParticleWatch, RoundingOfSpheresAtRestIsNoDifference) {
  ParticleWatch watch(two_spheres());
  watch.observe(flight_frame(0));
  Exchange rest = flight_window(0);
  rest.load.account.kinetic_energy = 9e-25;
  rest.load.account.momentum_end = {1e-14, 0, 0};
  watch.record(rest);
  ParticlesFrame frame = flight_frame(1);
  for (const std::size_t z : {2u, 5u}) frame.velocity[z] = 1e-13f;
  watch.observe(frame);
  EXPECT_LT(watch.differences()[0].share, 1e-3);
  EXPECT_LT(watch.differences()[1].share, 1e-3);
}

// Without gravity, and where no sphere has moved before, the frame has what rounding of a contact in single
// precision leaves, and the account nothing. What frames resolve is compared as ever.
TEST(ParticleWatch, RoundingWithoutGravityIsNoDifference) {
  for (const float speed : {1e-12f, 1e-7f}) {
    SceneFile file = two_spheres("", "[0, 0, 0]", "[0, 0, 0]");
    ParticleWatch watch(file);
    Exchange rest = flight_window(0);
    rest.load.account.momentum_begin = rest.load.account.momentum_end = {};
    rest.load.account.gravity_impulse = {};
    rest.load.account.kinetic_energy = 0;
    watch.record(rest);
    ParticlesFrame frame = flight_frame(0);
    frame.time = Nanoseconds{10'000'000};
    frame.velocity = {speed, 0, 0, -speed, 0, 0};
    watch.observe(frame);
    EXPECT_LT(watch.differences()[0].share, 1e-3);
    if (speed < 1e-8f)
      EXPECT_LT(watch.differences()[1].share, 1e-3) << watch.differences()[1].values;
    else
      EXPECT_GT(watch.differences()[1].share, 1e-3);
  }
}

TEST(ParticleWatch, ARestartHasLostItsSpheresBefore) {
  ParticlesFrame left = flight_frame(0);
  left.time = Nanoseconds{50'000'000};
  left.id.pop_back();
  left.radius.pop_back();
  for (auto* rows : {&left.velocity, &left.spin}) rows->resize(3);
  left.position.resize(3);
  for (const std::uint64_t lost : {0u, 1u}) {
    ParticleWatch watch(two_spheres());
    watch.continue_after(lost);
    watch.observe(left);
    EXPECT_EQ(watch.false_spheres()[0].spheres, 1 - lost);
  }
}

// A gravity that changes after the first window, by which a run judges the mass.
TEST(ParticleWatch, GravityIsThatOfTheSceneInEachWindow) {
  ParticleWatch watch(two_spheres());
  watch.record(flight_window(0));
  watch.observe(flight_frame(1));
  EXPECT_LT(watch.differences()[3].share, 1e-6);
  Exchange weaker = flight_window(1);
  weaker.load.account.gravity_impulse.z *= 0.9;
  watch.record(weaker);
  watch.observe(flight_frame(2));
  EXPECT_NEAR(watch.differences()[3].share, 0.1, 1e-6);
  weaker = flight_window(2);
  weaker.load.account.gravity_impulse = {};
  weaker.load.account.lost_particles = 1;
  watch.record(weaker);
  watch.observe(flight_frame(3));
  EXPECT_NEAR(watch.differences()[3].share, 0.1, 1e-6) << "a sphere that was lost had a part of it";
}

// Frames are checked later, in another thread: with the windows before them, not with those since.
TEST(ParticleWatch, ChecksFramesLater) {
  ParticleWatch at_once(two_spheres()), later(two_spheres());
  const ParticlesFrame start = flight_frame(0);
  at_once.observe(start);
  later.expect_start(start);
  std::vector<std::pair<ParticlesFrame, ParticleWatch::Before>> waiting{{start, later.take_before()}};
  for (int i = 0; i < 10; ++i) {
    at_once.record(flight_window(i));
    later.record(flight_window(i));
    if (i != 4 && i != 9) continue;
    ParticlesFrame seen = flight_frame(i + 1);
    seen.position[0] += 0.02 * i;
    seen.velocity[2] *= 0.99f;
    at_once.observe(seen);
    waiting.emplace_back(seen, later.take_before());
  }
  EXPECT_FALSE(later.compared());
  std::thread([&] {
    for (const auto& [frame, before] : waiting) later.check(frame, before);
  }).join();
  EXPECT_TRUE(later.compared());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(at_once.differences()[i].share, 0.0) << i;
    EXPECT_EQ(later.differences()[i].share, at_once.differences()[i].share) << i;
    EXPECT_EQ(later.differences()[i].values, at_once.differences()[i].values) << i;
    EXPECT_EQ(later.false_spheres()[i].spheres, at_once.false_spheres()[i].spheres) << i;
  }
}

// A sphere at rest on the floor at (0.3, 0, 0): the floor bears m g there.
double angular_balance(double torque_share, Vec3d origin_of_torque) {
  SceneFile file = two_spheres();
  ParticleWatch watch(file);
  ParticlesFrame rest = flight_frame(1);
  rest.position = {0.3, 0, 0, -0.1, 0, 0};
  rest.velocity.assign(6, 0);
  watch.observe(rest);
  for (int i = 0; i < 10; ++i) {
    Exchange exchange = flight_window(i + 1);
    protocol::ParticleAccount& a = exchange.load.account;
    a.momentum_begin = a.momentum_end = {};
    a.kinetic_energy = 0;
    protocol::BodyLoad load;
    load.body = ground.value;
    load.mean.force = {0, 0, -2 * sphere_kg * flight_g};
    load.mean.torque = torque_share * cross(Vec3d{0.1, 0, 0} - origin_of_torque, load.mean.force);
    exchange.load.bodies = {load};
    watch.record(exchange);
  }
  rest.time = Nanoseconds{110'000'000};
  watch.observe(rest);
  return watch.angular_momentum_balance().value_or(-1);
}

TEST(ParticleWatch, BalancesTheAngularMomentum) {
  EXPECT_LT(angular_balance(1, {}), 1e-6);  // radii of a frame are single precision
  // Relative to the torque, and to a tenth of the radius as a lever arm of the force.
  EXPECT_NEAR(angular_balance(0.9, {}), 0.01 / (0.09 + 0.001), 1e-6);
  EXPECT_NEAR(angular_balance(-1, {}), 0.2 / (0.1 + 0.001), 1e-6);
  EXPECT_NEAR(angular_balance(0, {}), 0.1 / 0.001, 1e-3) << "no torques at all";
  EXPECT_GT(angular_balance(1, {0.002, 0, 0}), 0.01) << "about another point";
}

}  // namespace
}  // namespace tandem::launch
