// The machines of launch/scenes, as they stand in their files, moved whole by random rigid motions: gravity,
// bodies, joints and forces. They move the same, up to the growth of round-off. A new scene without particles
// is tested as soon as it is in the folder. TANDEM_SOAK=1 tries more motions, of a random seed that is
// printed; TANDEM_SEED=N repeats one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "common/error.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/recorded_run.hpp"

namespace tandem::mbd {
namespace {

// Longer runs end here: what moves differently is seen before.
constexpr double most_windows = 2000;
// Deviation that no growth explains: increments below mbd.integrator.tolerance are not computed.
constexpr double smallest_limit = 1e-9;

// Names of the scenes, without ending. Runs with a controller need one, and the domain of particles has the
// axes of the world.
std::vector<std::string> machine_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(TANDEM_SCENES)) {
    if (entry.path().extension() != ".json") continue;
    try {
      const scene::Scene scene = launch::read_scene(entry.path()).scene;
      if (scene.has_particles() || !scene.mbd->sensors.empty()) continue;
    } catch (const Error&) {
      // The test of this scene reports it.
    }
    names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class MachineScene : public testing::TestWithParam<std::string> {};

TEST_P(MachineScene, MovesTheSameInEveryFrame) {
  const scene::Scene scene =
      launch::read_scene(std::filesystem::path(TANDEM_SCENES) / (GetParam() + ".json")).scene;
  const bool soak = std::getenv("TANDEM_SOAK") != nullptr;
  const char* given = std::getenv("TANDEM_SEED");
  const std::uint64_t seed = given ? std::strtoull(given, nullptr, 10) : soak ? std::random_device{}() : 35;
  if (soak) std::printf("TANDEM_SEED=%llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);

  const double window = scene.coupling.window, size = size_of(scene);
  const int windows = static_cast<int>(std::min(std::round(scene.end_time / window), most_windows));
  const double end = windows * window;
  const RecordedRun first = record(scene, end, windows);
  constexpr double share = 1e-8;
  const RecordedRun changed = record(heavier(scene, share, random), end, windows);
  const double growth = std::max(1.0, deviation(scene, first, changed).most() / share);

  std::printf("| %-18s | %10s | %7s | %8s | %8s | %8s | %8s | %8s | %8s |\n", "scene, motion", "distance",
              "end [s]", "growth", "poses", "speeds", "energy", "ground", "limit");
  for (int i = 0; i < (soak ? 30 : 2); ++i) {
    // The second one is far away, where the data themselves have lost digits.
    const double distance = size * (i % 2 == 0 ? 1 : 100);
    const test::RigidMotion motion(test::random_rotation(random), scene.mbd->bodies.front().pose.p_WB,
                                   distance * test::random_rotation(random).rotate({1, 0, 0}));
    const RecordedRun there = record(test::moved(scene, motion), end, windows);
    EXPECT_EQ(there.degrees_of_freedom, first.degrees_of_freedom);
    EXPECT_EQ(there.redundant, first.redundant);
    const Deviation d = deviation(scene, first, there, motion);
    const double round_off = std::numeric_limits<double>::epsilon() * distance / size;
    const double limit = smallest_limit + 100 * round_off * growth;
    std::printf("| %-18s | %8.3g m | %7.3g | %8.1e | %8.1e | %8.1e | %8.1e | %8.1e | %8.1e |\n",
                GetParam().c_str(), distance, end, growth, d.pose, d.velocity, d.energy, d.on_ground, limit);
    EXPECT_LE(d.most(), limit);
    EXPECT_LE(d.on_ground, 10 * limit);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, MachineScene, testing::ValuesIn(machine_scenes()),
                         [](const testing::TestParamInfo<std::string>& scene) { return scene.param; });

}  // namespace
}  // namespace tandem::mbd
