// Loads of a liquid at rest on the walls around and in it.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/scene/parse.hpp"
#include "sph_server/coupling/liquid_start.hpp"

namespace tandem::test {
namespace rest_loads_test {

// A tank of 0.4 x 0.2 m with water of depth 0.16 m and a block in it that hangs from above, and a gate in its
// side at x = 0.2, which is a body as well.
nlohmann::json tank() {
  return nlohmann::json::parse(R"({
    "tandem": "1.1", "name": "tank", "end_time": 0.1, "coupling": {"window": 0.002},
    "mbd": {"start": "equilibrium", "bodies": [
      {"name": "tank", "mass": 5, "inertia": [1, 1, 1], "position": [0, 0, 0.15]},
      {"name": "block", "mass": 2, "inertia": [1, 1, 1], "position": [0, 0, 0.12]},
      {"name": "gate", "mass": 2, "inertia": [1, 1, 1], "position": [0.2, 0, 0.1]}]},
    "sph": {
      "spacing": 0.02,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001,
                   "fill": [{"type": "inside", "wall": "case", "level": 0.16}]}],
      "walls": [
        {"name": "case", "body": "tank", "shape": {"type": "box", "size": [0.4, 0.2, 0.3], "open": ["+z", "+x"]}},
        {"name": "cube", "body": "block", "shape": {"type": "box", "size": [0.08, 0.08, 0.12]}},
        {"name": "side", "body": "gate", "shape": {"type": "box", "size": [1e-3, 0.2, 0.2],
                                                    "open": ["+x", "+y", "-y", "+z", "-z"]}}],
      "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}
    }
  })");
}

std::map<BodyId, Wrench> loads_of(const nlohmann::json& json) {
  const scene::Scene scene = scene::parse(json.dump(), "tank.json");
  scene::validate(scene, "tank.json");
  return sph::rest_loads_of(scene, {}, {});
}

constexpr double g = 9.81;

TEST(RestLoads, AreWeightBuoyancyAndPressure) {
  auto json = tank();
  json["mbd"]["bodies"][2]["position"][0] = 0.1995;  // its face is the side of the tank
  const auto loads = loads_of(json);
  const double submerged = 0.08 * 0.08 * 0.1, mass = 1000 * (0.4 * 0.2 * 0.16 - submerged);
  const Wrench block = loads.at(BodyId{1}), gate = loads.at(BodyId{2}), all = loads.at(BodyId{0});
  EXPECT_NEAR(block.force.z, 1000 * g * submerged, 0.01 * 1000 * g * submerged);
  EXPECT_NEAR(block.force.x, 0, 0.05);
  EXPECT_NEAR(gate.force.x, 0.5 * 1000 * g * 0.16 * 0.16 * 0.2, 0.015 * 25);
  // About its centre, 0.1 m high: the pressure acts at a third of the depth.
  EXPECT_NEAR(gate.torque.y, gate.force.x * (0.16 / 3 - 0.1), 0.02);
  EXPECT_NEAR(all.force.z + block.force.z, -mass * g, 0.003 * mass * g);
  EXPECT_NEAR(all.force.x + gate.force.x, 0, 0.05);
}

TEST(RestLoads, MoveWithTheVessel) {
  auto json = tank();
  json["sph"]["walls"].erase(2);
  json["sph"]["walls"][0]["shape"]["open"] = {"+z"};
  const scene::Scene scene = scene::parse(json.dump(), "tank.json");
  sph::LiquidStart start = sph::prepare_start(scene, {});
  sph::LiquidState liquid = sph::particles_of(start, scene);
  const Vec3d before = liquid.position[7];
  const std::map<std::uint32_t, Pose> down{{0, {{0, 0, 0.12}, {}}}, {1, {{0, 0, 0.09}, {}}}};
  EXPECT_FALSE(sph::move_to(down, scene, start, liquid));
  EXPECT_NEAR(liquid.position[7].z, before.z - 0.03, 1e-12);
  EXPECT_NEAR(start.poses[0].p.z, 0.12, 1e-12);
  try {
    sph::move_to({{0, {{0, 0, 0.12}, {}}}, {1, {{0, 0, 0.10}, {}}}}, scene, start, liquid);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("wall of 'block' 0.01 m away"), std::string::npos)
        << error.what();
  }
}

}  // namespace rest_loads_test
}  // namespace tandem::test
