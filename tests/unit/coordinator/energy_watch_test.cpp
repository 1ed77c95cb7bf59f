// Energies of frames that are not those of the poses and velocities.
#include "coordinator/watch/energy_watch.hpp"

#include <gtest/gtest.h>

#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

scene::Scene scene_with_force(const std::string& force, const std::string& joint = "") {
  return scene::parse(
      R"({"tandem": "1.1", "name": "energy", "gravity": [0, 0, -10], "end_time": 1, "coupling": {"window": 0.1},
  "mbd": {"bodies": [{"name": "top", "mass": 2, "inertia": [0.5, 1, 2], "orientation": [0.6, 0.8, 0, 0]}],
          "joints": [)" +
          joint + R"(], "forces": [)" + force + "]}}",
      "test");
}

protocol::BodiesFrame energy_frame(double height, double speed, Vec3d spin_of_body, double energy) {
  protocol::BodiesFrame frame;
  frame.time = Nanoseconds{100'000'000};
  protocol::BodyState& state = frame.bodies.emplace_back();
  state.pose = {{0, 0, height}, {0.6, 0.8, 0, 0}};
  state.twist = {{0, speed, 0}, state.pose.q_WB.rotate(spin_of_body)};
  frame.energy = energy;
  return frame;
}

// Changes from a frame at rest to one at 3 m, with 4 m/s and a spin: 2 10 3 + 2 16 / 2 + (0.5 + 4 + 18) / 2
// J.
constexpr double moved = 60 + 16 + 11.25;
std::optional<EnergyWatch::Difference> change(const scene::Scene& scene, double energy) {
  EnergyWatch watch(scene);
  watch.observe(energy_frame(0, 0, {}, 7));
  EXPECT_FALSE(watch.largest());
  watch.observe(energy_frame(3, 4, {1, 2, 3}, 7 + energy));
  return watch.largest();
}

TEST(EnergyWatch, KineticAndPotentialEnergyAreThoseOfTheScene) {
  const auto right = change(scene_with_force(""), moved);
  ASSERT_TRUE(right);
  EXPECT_LT(right->share, 1e-14);
  const auto wrong = change(scene_with_force(""), 1e6 * moved);
  EXPECT_GT(wrong->share, 1e5);
  EXPECT_NEAR(wrong->computed, moved, 1e-12);
  EXPECT_NEAR(wrong->reported, 1e6 * moved, 1e-6);
}

TEST(EnergyWatch, LinearSpringsAreKnown) {
  const scene::Scene scene = scene_with_force(
      R"({"name": "s", "type": "spring_damper", "body_b": "top", "point_a": [0, 0, 10], "point_b": [0, 0, 1], "stiffness": 100, "length": 8})");
  // The point of the spring is at 4 m: it is 6 m long, after 9 m.
  const double spring = 0.5 * 100 * (2 * 2 - 1);
  EXPECT_LT(change(scene, moved + spring)->share, 1e-14);
  EXPECT_GT(change(scene, moved)->share, 0.1);
}

// What contacts store counts where the participant tells it.
TEST(EnergyWatch, ContactsAreKnownByTheirAccount) {
  scene::Scene scene = scene_with_force("");
  scene.contact.emplace();
  const auto share = [&](bool told) {
    EnergyWatch watch(scene);
    for (const bool later : {false, true}) {
      protocol::BodiesFrame frame =
          later ? energy_frame(3, 4, {1, 2, 3}, 7 + moved + 5) : energy_frame(0, 0, {}, 7);
      if (told) frame.contacts = {later ? 5. : 0.};
      watch.observe(frame);
    }
    return watch.largest();
  };
  ASSERT_TRUE(share(true));
  EXPECT_LT(share(true)->share, 1e-14);
  EXPECT_FALSE(share(false));
}

TEST(EnergyWatch, OtherStoresAreNotJudged) {
  EXPECT_TRUE(change(
      scene_with_force(
          R"({"name": "f", "type": "force", "body": "top", "point": [0, 0, 0], "direction": [0, 0, 1], "size": {"type": "constant", "value": 1}})"),
      0));
  for (
      const char* store :
      {R"({"name": "s", "type": "spring_damper", "body_b": "top", "point_a": [0, 0, 10], "point_b": [0, 0, 1], "table": {"arguments": [-1, 1], "values": [-5, 9]}, "length": 8})",
       R"({"name": "r", "type": "rope", "points": [{"body": "ground", "point": [0, 0, 5]}, {"body": "top", "point": [0, 0, 0]}], "length": 5, "axial_stiffness": 100})"})
    EXPECT_FALSE(change(scene_with_force(store), 0)) << store;
  EXPECT_FALSE(change(
      scene_with_force(
          "",
          R"({"name": "j", "type": "revolute", "child": "top", "position": [0, 0, 0], "axis": [0, 0, 1], "limits": {"lower": -1, "upper": 1, "stiffness": 10}})"),
      0));
}

}  // namespace
}  // namespace tandem::launch
