// The coordinator's own restart file with wrong values and a correct digest: the run is refused with the
// fault, or continues, or fails like any other.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "coordinator/run/run.hpp"
#include "coordinator/window/checkpoint.hpp"
#include "tests/support/damaged_state.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

class DamagedRun : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    nlohmann::json scene = nlohmann::json::parse(
        std::ifstream(fs::path(TANDEM_SOURCE_DIR) / "tests/system/scenes/hanging_box.json"));
    scene.erase("checks");
    // All kinds of state of a coupling: columns of earlier windows, an adaptive length.
    scene["coupling"] =
        nlohmann::json::parse(R"({"scheme": "implicit", "window": 5e-4, "iteration": {"method": "iqn_ils"},
      "adaptive": {"energy_tolerance": 1e-2, "path_tolerance": 1e-5, "min_window": 1e-5, "max_window": 1e-3}})");
    std::ofstream(folder_ / "scene.json") << scene;
  }
  void TearDown() override { fs::remove_all(folder_); }

  RunOptions options(const char* out, double end_time) const {
    RunOptions options;
    options.scene = folder_ / "scene.json";
    options.folder = folder_ / out;
    options.overrides.end_time = end_time;
    options.transport = Transport::inproc;
    options.threads = 1;
    options.picture = options.report = false;
    options.quiet = true;
    return options;
  }
  nlohmann::json summary_of(const RunOptions& options) const {
    return nlohmann::json::parse(std::ifstream(options.folder / "summary.json"));
  }

  const fs::path folder_ = fs::temp_directory_path() / ("tandem_damaged_run_" + std::to_string(getpid()));
};

TEST_F(DamagedRun, IsRefusedOrGoesOn) {
  RunOptions first = options("first", 0.05);
  first.checkpoint_every = 0.05;
  ASSERT_EQ(run(first), 0);
  const fs::path checkpoint = find_checkpoint(first.folder), run_file = checkpoint / "run.h5",
                 sound = folder_ / "sound.h5";
  fs::copy_file(run_file, sound);

  RunOptions next = options("next", 0.052);
  next.restart = first.folder;
  ASSERT_EQ(run(next), 0) << "a sound file";

  constexpr int files = 150;
  int refused = 0, failed = 0;
  for (int seed = 0; seed < files; ++seed) {
    SCOPED_TRACE(tandem::test::damage_state(sound, run_file, static_cast<std::uint64_t>(seed)));
    const int status = run(next);
    if (status == 0) continue;
    const nlohmann::json summary = summary_of(next), error = summary.value("error", nlohmann::json::object());
    EXPECT_NE(status, 70) << error;
    (error.value("where", "").find("run.h5") != std::string::npos ? refused : failed)++;
  }
  std::printf("%d of %d refused, %d failed later\n", refused, files, failed);
  EXPECT_GT(refused, files / 4);
}

}  // namespace
}  // namespace tandem::launch
