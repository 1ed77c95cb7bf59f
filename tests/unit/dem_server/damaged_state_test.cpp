// Restart files of the particle solver with wrong values and a matching digest: each is refused with an error
// that names the value, or its run continues or fails like any other.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <filesystem>

#include "common/error.hpp"
#include "particles/state/window_progress.hpp"
#include "tests/support/damaged_state.hpp"
#include "tests/support/solver_run.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;

// A heap of spheres on a floor, some of them moving, with an inlet and an outlet above them.
json heap(bool extended) {
  json scene = json::parse(R"({"tandem": "1.1", "name": "heap", "end_time": 1, "gravity": [0, 0, -9.81],
    "coupling": {"window": 0.001},
    "dem": {
      "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
      "pairs": [{"a": "glass", "b": "glass", "restitution": 0.6, "friction": 0.4}],
      "particles": [
        {"name": "bed", "material": "glass", "radius": 0.01, "velocity": [0.1, 0, -0.5],
         "fill": {"type": "lattice", "min": [-0.05, -0.05, 0], "max": [0.05, 0.05, 0.06], "spacing": 0.02}},
        {"name": "rain", "material": "glass", "radius": 0.01,
         "fill": {"type": "inlet", "min": [-0.05, -0.05, 0.2], "max": [0.05, 0.05, 0.25], "rate": 500, "count": 9}}],
      "outlets": [{"name": "drain", "region": {"type": "box", "min": [0.06, -0.1, 0], "max": [0.1, 0.1, 0.05]}}],
      "walls": [{"name": "floor", "material": "glass",
                 "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
      "domain": {"min": [-0.2, -0.2, -0.1], "max": [0.2, 0.2, 0.3]}}})");
  if (!extended) return scene;
  scene["dem"]["domain"]["periodic"] = {"y"};
  scene["dem"]["precision"] = "double";
  scene["dem"]["pairs"][0]["rolling_friction"] = 0.1;
  scene["dem"]["outlets"] = json::array();
  return scene;
}

class DamagedParticleState : public testing::TestWithParam<bool> {
 protected:
  void TearDown() override {
    std::filesystem::remove(sound_);
    std::filesystem::remove(damaged_);
  }
  const std::string base_ =
      std::filesystem::temp_directory_path() / ("tandem_heap_" + std::to_string(getpid()));
  const std::string sound_ = base_ + ".h5", damaged_ = base_ + "_damaged.h5";
};

TEST_P(DamagedParticleState, IsRefusedOrGoesOn) {
  constexpr int windows = 12, files = 400;
  const auto run = [] { return SolverRun(heap(GetParam()), "heap.json", 1, "cpu"); };
  SolverRun straight = run();
  for (int i = 0; i < windows; ++i) straight.advance_window({});
  const Nanoseconds now = straight.now;
  straight.solver->checkpoint({windows, now, sound_});
  straight.advance_window({});

  const auto resume = [&](const std::string& path) {
    SolverRun resumed = run();
    resumed.solver->resume({windows, now, path});
    resumed.now = now, resumed.windows = windows;
    return resumed;
  };
  SolverRun sound = resume(sound_);
  sound.advance_window({});
  EXPECT_EQ(sound.hash(), straight.hash());

  int refused = 0, failed = 0;
  for (int seed = 0; seed < files; ++seed) {
    const std::string what = damage_state(sound_, damaged_, static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(what);
    std::optional<SolverRun> resumed;
    try {
      resumed.emplace(resume(damaged_));
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), damaged_) << error.what();
      ++refused;
      continue;
    }
    try {
      for (int i = 0; i < 3; ++i) resumed->advance_window({});
      resumed->solver->linearise();
      resumed->solver->observe();
      resumed->solver->report();
    } catch (const Error&) {
      ++failed;
    }
  }
  std::printf("%d of %d refused, %d failed later\n", refused, files, failed);
  EXPECT_GT(refused, files / 4);
}

// Each of the 36 + 9 spheres is there, waits or has gone out: the floor keeps all of them inside the domain.
TEST_P(DamagedParticleState, MoreLostSpheresThanAreMissingAreRefused) {
  const auto run = [] { return SolverRun(heap(GetParam()), "heap.json", 1, "cpu"); };
  SolverRun straight = run();
  for (int i = 0; i < 3; ++i) straight.advance_window({});
  straight.solver->checkpoint({3, straight.now, sound_});
  const auto refusal = [&](const std::vector<std::string>& arrays, std::size_t at,
                           std::uint64_t value) -> std::string {
    std::filesystem::path from = sound_;
    for (const std::string& array : arrays) {
      change_state(from, damaged_, array,
                   [&](std::span<std::byte> bytes) { std::memcpy(bytes.data() + at, &value, sizeof value); });
      from = damaged_;
    }
    try {
      run().solver->resume({3, straight.now, damaged_});
    } catch (const Error& error) {
      return error.problem();
    }
    return "none";
  };
  const std::size_t lost = offsetof(particles::WindowProgress, lost);
  EXPECT_EQ(refusal({"engine/host_window_progress", "engine/window_progress"}, lost, 1'000'000),
            "its array 'host_window_progress' is damaged: it has lost more spheres than are missing");
  EXPECT_EQ(refusal({"engine/host_window_progress"}, lost, 1),
            "its array 'window_progress' is damaged: it differs from 'host_window_progress'");
  EXPECT_EQ(refusal({"lost"}, 0, 1'000'000),
            "its array 'lost' is damaged: it has lost more spheres than there are");
}

INSTANTIATE_TEST_SUITE_P(Laws, DamagedParticleState, testing::Values(false, true));

}  // namespace
}  // namespace tandem::test
