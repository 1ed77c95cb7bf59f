// The balance of energy of a drum that a motor turns: what the motor gives is in the drum and in the grains,
// or damping of the axle and contacts of the grains have dissipated it, each by its own account.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/verification/coupling/real_run.hpp"

namespace tandem::test {
namespace drum_energy_test {

using Json = nlohmann::json;

constexpr double grain_density = 2500, grain_gravity = 9.81;

Json drum_scene(const std::string& law) {
  Json scene = Json::parse(R"({
    "tandem": "1.1", "name": "drum", "end_time": 1.0, "coupling": {"scheme": "dem_first", "window": 0.001},
    "mbd": {
      "bodies": [{"name": "drum", "mass": 4, "inertia": [0.03, 0.05, 0.03]}],
      "joints": [{"name": "axle", "type": "revolute", "child": "drum", "position": [0, 0, 0], "axis": [0, 1, 0], "damping": 0.05}],
      "forces": [{"name": "drive", "type": "motor", "joint": "axle", "gear_ratio": 30, "control": "speed",
                  "target": {"type": "ramp", "to": 6.0, "duration": 0.3}, "gains": {"proportional": 40, "integral": 400},
                  "torque_speed": {"arguments": [0, 200, 400], "values": [2, 2, 0]}}]},
    "dem": {
      "materials": [{"name": "grain", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.5,
                     "spring_stiffness": 5000}],
      "micro_step": 1e-5,
      "particles": [{"name": "grains", "material": "grain", "radius": [0.008, 0.01],
                     "fill": {"type": "lattice", "min": [-0.063, -0.045, -0.102], "max": [0.063, 0.045, -0.018], "spacing": 0.0205, "jitter": 0.5}}],
      "walls": [
        {"name": "shell", "body": "drum", "material": "grain", "orientation": {"axis": [1, 0, 0], "angle_deg": 90},
         "shape": {"type": "cylinder", "radius": 0.12, "height": 0.1, "segments": 36}},
        {"name": "lifter_1", "body": "drum", "material": "grain", "position": [0.11, 0, 0], "shape": {"type": "box", "size": [0.02, 0.099, 0.015]}},
        {"name": "lifter_2", "body": "drum", "material": "grain", "position": [-0.11, 0, 0], "shape": {"type": "box", "size": [0.02, 0.099, 0.015]}}],
      "domain": {"min": [-0.13, -0.06, -0.13], "max": [0.13, 0.06, 0.13]}},
    "output": {"dissipation": true}})");
  scene["dem"]["contact"] = law;
  return scene;
}

// Of translation, rotation and weight of the grains [J].
double energy_of_grains(const protocol::ParticlesFrame& grains) {
  double energy = 0;
  for (std::size_t i = 0; i < grains.id.size(); ++i) {
    const double r = static_cast<double>(grains.radius[i]),
                 mass = grain_density * 4.0 / 3 * std::numbers::pi * r * r * r;
    double v2 = 0, w2 = 0;
    for (std::size_t a = 3 * i; a < 3 * i + 3; ++a) {
      v2 += static_cast<double>(grains.velocity[a]) * static_cast<double>(grains.velocity[a]);
      w2 += static_cast<double>(grains.spin[a]) * static_cast<double>(grains.spin[a]);
    }
    energy += mass * (0.5 * v2 + 0.2 * r * r * w2 + grain_gravity * grains.position[3 * i + 2]);
  }
  return energy;
}

class DrumEnergy : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Laws, DrumEnergy, testing::Values("hertz_mindlin", "hooke"));

TEST_P(DrumEnergy, OfTheMotorIsStoredOrDissipated) {
  RealRun run(drum_scene(GetParam()).dump());
  const double grains_before = energy_of_grains(run.dem.observe());
  const double duration = 1.0;
  run.run(duration);
  const double grains = energy_of_grains(run.dem.observe()) - grains_before;
  const Json of_mbd = Json::parse(run.mbd.report().facts), of_dem = Json::parse(run.dem.report().facts);
  const double drum = of_mbd["mbd_energy_end_J"].get<double>() - of_mbd["mbd_energy_start_J"].get<double>(),
               damped = of_mbd["mbd_dissipated_J"], motor = of_mbd["mbd_work_J"]["actuators"];
  double contacts = 0;
  for (const auto& part : of_dem["dem_dissipated_J"]) contacts += part.get<double>();
  const double balance = drum + grains + damped + contacts, tolerance = 0.01 * motor;
  std::printf("  %s, %zu grains, %.3g s\n", GetParam(), run.dem.observe().id.size(), duration);
  std::printf(
      "  | energy of the motor | drum | grains | damping of the axle | contacts: damping | friction | sum | "
      "tolerance |\n");
  std::printf("  | %.5g J | %.5g J | %.5g J | %.5g J | %.5g J | %.5g J | %.5g J | %.2g J |\n", motor, drum,
              grains, damped, of_dem["dem_dissipated_J"]["normal_damping"].get<double>(),
              of_dem["dem_dissipated_J"]["friction"].get<double>(), balance, tolerance);
  EXPECT_NEAR(balance, motor, tolerance);
  // Every term matters: without it the balance would be open.
  for (const double term : {drum, grains, damped, contacts}) EXPECT_GT(term, 2 * tolerance);
}

}  // namespace drum_energy_test
}  // namespace tandem::test
