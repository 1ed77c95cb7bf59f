// What the coordinator sees in a run of a participant that does not apply, or does not give, all of the load,
// whatever that participant reports.
#include "coordinator/accounts/body_momentum.hpp"

#include <gtest/gtest.h>

#include "common/scene/parse.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "tests/doubles/broken_load.hpp"
#include "tests/doubles/broken_motion.hpp"
#include "tests/doubles/coupled_run.hpp"

namespace tandem::test {
namespace body_momentum_test {

using namespace protocol;

// Grains hit a plate off its centre.
std::string plate_scene(const std::string& joints, const std::string& gravity = "[0, 0, -9.81]") {
  return R"({
  "tandem": "1.1", "name": "plate", "gravity": )" +
         gravity + R"(, "end_time": 0.1, "coupling": {"window": 0.001},
  "mbd": {
    "bodies": [{"name": "plate", "mass": 2, "inertia": [0.02, 0.03, 0.05, 0.002, 0.001, 0.003], "velocity": [0.1, 0, 0],
                "angular_velocity": [0.5, -1, 2]}],
    "joints": [)" +
         joints + R"(]},
  "dem": {
    "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.4, "friction": 0.3}],
    "particles": [{"name": "grains", "material": "glass", "radius": 0.02, "velocity": [-1, 0, -1.5],
                   "fill": {"type": "lattice", "min": [0.05, -0.1, 0.06], "max": [0.2, 0.1, 0.3], "spacing": 0.045, "jitter": 0.5,
                            "seed": 1, "count": 24}}],
    "walls": [{"name": "face", "body": "plate", "material": "glass", "shape": {"type": "box", "size": [0.5, 0.5, 0.1]}}],
    "domain": {"min": [-2, -2, -2], "max": [2, 2, 2]}
  }
})";
}
const std::string free_plate = plate_scene("");
const std::string flap = plate_scene(
    R"({"name": "hinge", "type": "revolute", "child": "plate", "position": [0, 0, 0], "axis": [0, 1, 0]})");
const std::string sledge = plate_scene(
    R"({"name": "slide", "type": "prismatic", "child": "plate", "position": [0, 0, 0], "axis": [1, 0, 0]})");

struct Seen {
  double linear = 0, angular = 0;             // of the plate
  double impulse_closure = 0;                 // of what the participant reports
  double momentum = 0, momentum_windows = 0;  // of the particles
};
Seen run(const std::string& text, MotionSolver& mbd, LoadSolver& dem,
         const std::string& scheme = "dem_first") {
  scene::Scene scene = scene::parse(text, "test");
  if (scheme == "mbd_first") scene.coupling.scheme = scene::Scheme::mbd_first;
  if (scheme == "implicit") scene.coupling.scheme = scene::Scheme::implicit;
  CoupledRun coupled(mbd, dem, scene, text);
  coupled.run(0.1);
  const launch::Coupler& coupler = coupled.coupler();
  const auto& sums = coupler.body_momentum().sums().at(0);
  const Seen seen{sums.linear(), sums.angular(), coupler.accounts().impulse_closure(),
                  coupler.accounts().particles().momentum(),
                  coupler.accounts().particles().momentum_windows()};
  std::printf("  %s: linear %.2e, angular %.2e, closure %.2e, particles %.2e, in windows %.2e\n",
              scheme.c_str(), seen.linear, seen.angular, seen.impulse_closure, seen.momentum,
              seen.momentum_windows);
  return seen;
}
Seen run_broken(const std::string& text, const MotionFault& fault) {
  return run(text, *broken(fault), *dem::make_solver());
}

// The limit of the rule body_angular_momentum; that of body_momentum is smaller.
constexpr double most = 0.01;

// Reports the load that it was given.
void echo_loads(MotionSet& motion, const LoadSet& given) {
  for (BodyMotion& body : motion.bodies)
    for (const BodyLoad& load : given.bodies)
      if (load.body == body.body)
        body.applied_impulse = {given.window.length() * load.mean.force,
                                given.window.length() * load.mean.torque};
}

TEST(BodyMomentum, OfOurSolversIsClosedInEveryScheme) {
  for (const std::string& scene : {free_plate, flap, sledge})
    for (const char* scheme : {"dem_first", "mbd_first", "implicit"}) {
      const Seen seen = run(scene, *mbd::make_solver(), *dem::make_solver(), scheme);
      EXPECT_LT(seen.linear, 0.01 * most);
      EXPECT_LT(seen.angular, 0.01 * most);
      EXPECT_LT(seen.momentum_windows, 1e-9);
    }
}

TEST(BodyMomentum, DroppedTorquesAreSeenThoughAllImpulsesAreReported) {
  const MotionFault fault{.name = "drops_torques",
                          .load =
                              [](LoadSet& loads) {
                                for (BodyLoad& load : loads.bodies) load.mean.torque = {};
                              },
                          .motion = echo_loads};
  const Seen free = run_broken(free_plate, fault), hinged = run_broken(flap, fault);
  EXPECT_LT(free.impulse_closure, 1e-12);
  EXPECT_LT(free.linear, 0.01 * most);
  EXPECT_GT(free.angular, 2 * most);
  EXPECT_GT(hinged.angular, 2 * most);
}

TEST(BodyMomentum, OtherFaultsOfTheLoadAreSeen) {
  const MotionFault sign{.name = "force_sign",
                         .load =
                             [](LoadSet& loads) {
                               for (BodyLoad& load : loads.bodies) load.mean.force = -load.mean.force;
                             },
                         .motion = echo_loads};
  EXPECT_GT(run_broken(free_plate, sign).linear, 2 * most);
  EXPECT_GT(run_broken(sledge, sign).linear, 2 * most);
  const MotionFault late{.name = "load_of_last_window", .motion = echo_loads, .delays_load = true};
  EXPECT_GT(run_broken(free_plate, late).angular, 2 * most);
  EXPECT_GT(run_broken(sledge, late).linear, 2 * most);
  const MotionFault axes{.name = "torque_in_body_axes",
                         .load =
                             [](LoadSet& loads) {
                               for (BodyLoad& load : loads.bodies)
                                 std::swap(load.mean.torque.x, load.mean.torque.y);
                             },
                         .motion = echo_loads};
  EXPECT_GT(run_broken(free_plate, axes).angular, 2 * most);
  const MotionFault units{.name = "gravity_in_other_units", .scene = [](Configuration& c) {
                            c.scene_text.replace(c.scene_text.find("-9.81"), 5, "-0.98");
                          }};
  EXPECT_GT(run_broken(free_plate, units).linear, 2 * most);
}

TEST(BodyMomentum, LoadsOfAnotherWindowAreSeenInSingleWindowsOnly) {
  const LoadFault late{.name = "load_of_last_window", .delays_load = true};
  const Seen seen = run(free_plate, *mbd::make_solver(), *broken(late));
  EXPECT_GT(seen.momentum_windows, 10 * seen.momentum);
  EXPECT_GT(seen.momentum_windows, 0.01);
  const LoadFault end{.name = "end_for_mean", .load = [](LoadSet& loads, const MotionSet&) {
                        for (BodyLoad& load : loads.bodies) load.mean = load.end;
                      }};
  EXPECT_GT(run(free_plate, *mbd::make_solver(), *broken(end)).momentum_windows, 0.01);
}

// The plate meets the floor with a corner, slides and comes to rest on it, while grains hit it.
std::string plate_on_a_floor() {
  std::string text = free_plate;
  const auto put = [&](const std::string& before, const std::string& what) {
    text.insert(text.find(before), what);
  };
  put(R"("joints": [)",
      R"("contact": {"materials": [{"name": "steel", "stiffness": 1e5, "restitution": 0.5, "friction": 0.4}],
      "ground": [{"name": "floor", "material": "steel", "shape": {"type": "plane", "point": [0, 0, -0.06], "normal": [0, 0, 1]}}]}, )");
  put(R"("velocity": [0.1, 0, 0])",
      R"("shapes": [{"name": "sole", "use": "contact", "material": "steel", "shape": {"type": "box", "size": [0.5, 0.5, 0.1]}}], )");
  return text;
}
launch::BodyMomentum::Sums momentum_of_touching(const std::string& scheme, double window,
                                                const MotionFault& fault) {
  const std::string text = plate_on_a_floor();
  scene::Scene scene = scene::parse(text, "test");
  scene.coupling.window = window;
  if (scheme == "implicit") scene.coupling.scheme = scene::Scheme::implicit;
  const auto mbd = broken(fault);
  const auto dem = dem::make_solver();
  CoupledRun coupled(*mbd, *dem, scene, text);
  coupled.observe();
  while (coupled.coupler().now() < to_nanoseconds(0.15)) coupled.advance(window), coupled.observe();
  const auto& sums = coupled.coupler().body_momentum().sums();
  if (!sums.contains(0)) return {};
  const launch::BodyMomentum::Sums seen = sums.at(0);
  std::printf("  %s, windows of %g s: linear %.2e (limit 1e-3), angular %.2e (limit 1e-2)\n", scheme.c_str(),
              window, seen.linear(), seen.angular());
  return seen;
}

TEST(BodyMomentum, OfABodyInContactIsClosedByItsAccount) {
  for (const auto& [scheme, window] :
       {std::pair{"dem_first", 1e-3}, {"dem_first", 2e-4}, {"implicit", 1e-3}}) {
    const auto sums = momentum_of_touching(scheme, window, {});
    EXPECT_GT(sums.impulse, 1) << "the floor bears the plate";
    EXPECT_LT(sums.linear(), 1e-3);
    EXPECT_LT(sums.angular(), 1e-2);
  }
}

TEST(BodyMomentum, AFaultOfTheContactsIsSeenAndAMissingAccountIsNotJudged) {
  const auto sums =
      momentum_of_touching("dem_first", 1e-3, {.name = "contacts_too_large", .frame = [](BodiesFrame& frame) {
                                                 for (double& value : frame.contacts) value *= 1.01;
                                               }});
  EXPECT_GT(sums.linear(), 2e-3);
  const auto none = momentum_of_touching(
      "dem_first", 1e-3,
      {.name = "without_an_account", .frame = [](BodiesFrame& frame) { frame.contacts.clear(); }});
  EXPECT_EQ(none.impulse, 0);
}

TEST(BodyMomentum, OnlyBodiesWithoutOtherForcesAreWatched) {
  const auto watched = [](const std::string& text) {
    launch::BodyMomentum momentum(scene::parse(text, "test"));
    launch::Exchange exchange;
    exchange.motion.window = {0, {}, {1'000'000}};
    exchange.motion.bodies.emplace_back();
    momentum.record(exchange);
    return momentum.sums().contains(0);
  };
  EXPECT_TRUE(watched(free_plate));
  EXPECT_TRUE(watched(flap));
  EXPECT_TRUE(watched(sledge));
  for (
      const char* joint :
      {R"({"name": "j", "type": "spherical", "child": "plate", "position": [0, 0, 0]})",
       R"({"name": "j", "type": "revolute", "child": "plate", "position": [0, 0, 0], "axis": [0, 1, 0], "damping": 1})",
       R"({"name": "j", "type": "revolute", "child": "plate", "position": [0, 0, 0], "axis": [0, 1, 0], "motion": {"type": "constant", "rate": 1}})",
       R"({"name": "j", "type": "revolute", "child": "plate", "position": [0, 0, 0], "axis": [0, 1, 0], "friction": {"force": 1, "slip": 0.1}})"})
    EXPECT_FALSE(watched(plate_scene(joint))) << joint;
  std::string driven = free_plate;
  driven.replace(
      driven.find("\"joints\""), 0,
      R"("forces": [{"name": "f", "type": "torque", "body": "plate", "direction": [0, 0, 1], "size": {"type": "constant", "value": 1}}], )");
  EXPECT_FALSE(watched(driven));
}

}  // namespace body_momentum_test
}  // namespace tandem::test
