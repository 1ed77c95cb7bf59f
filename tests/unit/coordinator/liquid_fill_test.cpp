// The liquid inside a wall is filled in before the start, with a cache; an interrupt ends it.
#include "coordinator/scene/liquid_fill.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/error.hpp"
#include "common/scene/particle_file.hpp"
#include "sph_server/coupling/make_solver.hpp"

namespace tandem::launch {
namespace liquid_fill_test {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class LiquidFill : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("tandem_liquid_fill_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    setenv("TANDEM_CACHE", (folder_ / "cache").c_str(), 1);
    unsetenv("TANDEM_CACHE_MB");
    scene_ = nlohmann::json::parse(R"({"tandem": "1.1", "name": "mug", "end_time": 0.01,
      "sph": {"spacing": 0.02,
        "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001,
                     "fill": [{"type": "inside", "wall": "mug", "level": 0.07}]}],
        "walls": [{"name": "mug", "position": [0, 0, 0.06],
                   "shape": {"type": "cylinder", "radius": 0.05, "height": 0.12, "segments": 8, "open": ["+z"]}}],
        "domain": {"min": [-0.2, -0.2, -0.1], "max": [0.2, 0.2, 0.3]}}})");
  }
  void TearDown() override {
    unsetenv("TANDEM_CACHE");
    fs::remove_all(folder_);
  }
  SceneFile read(const SettleOn& on = {}) {
    std::ofstream(folder_ / "scene.json") << scene_.dump();
    return read_scene(folder_ / "scene.json", {}, on);
  }
  std::vector<fs::path> kept() const {
    std::vector<fs::path> files;
    if (fs::exists(folder_ / "cache"))
      for (const auto& entry : fs::directory_iterator(folder_ / "cache")) files.push_back(entry.path());
    return files;
  }

  fs::path folder_;
  nlohmann::json scene_;
};

TEST_F(LiquidFill, IsKeptForTheNextRunWithTheSameBits) {
  const SceneFile first = read({"cpu", 1});
  ASSERT_EQ(first.files.size(), 1u);
  EXPECT_EQ(first.files[0].name, "sph.liquids[0].fill[0]");
  const scene::ParticleFile places = scene::read_particle_file(first.files[0].text, "mug");
  // The octagon has 0.0070711 m2.
  EXPECT_NEAR(static_cast<double>(places.positions.size()), 0.0070711 * 0.07 / 8e-6, 0.5);
  EXPECT_THAT(first.log, Contains(HasSubstr("the filled liquid is kept in")));
  const SceneFile second = read({"cpu", 2});
  EXPECT_EQ(second.files[0].text, first.files[0].text);
  EXPECT_THAT(second.log, Contains(HasSubstr("are taken from the cache")));
  // What does not concern the places changes nothing.
  scene_["end_time"] = 0.02;
  EXPECT_THAT(read().log, Contains(HasSubstr("are taken from the cache")));
  setenv("TANDEM_CACHE", "off", 1);
  EXPECT_EQ(read({"cpu", 2}).files[0].text, first.files[0].text);
}

TEST_F(LiquidFill, OfAnotherLevelOrOfADamagedFileIsMadeAnew) {
  const SceneFile first = read();
  ASSERT_EQ(kept().size(), 1u);
  const fs::path file = kept()[0];
  EXPECT_TRUE(file.filename().string().starts_with("filled_"));
  {
    std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekp(-40, std::ios::end);
    damaged.put('x');
  }
  const SceneFile second = read();
  EXPECT_THAT(second.log, Contains(HasSubstr("a filled liquid in the cache is not used, and is made anew")));
  EXPECT_EQ(second.files[0].text, first.files[0].text);
  scene_["sph"]["liquids"][0]["fill"][0]["level"] = 0.075;
  EXPECT_NE(read().files[0].text, first.files[0].text);
  EXPECT_EQ(kept().size(), 2u);
}

TEST_F(LiquidFill, IsLeftToTheSolverWhereALatticeFitsOrAnotherProgramComputes) {
  EXPECT_THAT(read({.fills = false}).files, IsEmpty());
  EXPECT_THAT(read({.settles = false}).files, IsEmpty());
  scene_["sph"]["walls"][0]["shape"] = {{"type", "box"}, {"size", {0.12, 0.08, 0.12}}, {"open", {"+z"}}};
  scene_["sph"]["liquids"][0]["fill"][0]["level"] = 0.08;
  EXPECT_THAT(read().files, IsEmpty());
}

TEST_F(LiquidFill, IsTheOneThatTheSolverWouldPlace) {
  const SceneFile file = read();
  const auto start = [&](const std::vector<protocol::NamedText>& files) {
    const auto solver = sph::make_solver();
    solver->configure({file.text, file.origin, file.meshes, files, "cpu", 1});
    return solver->observe().position;
  };
  EXPECT_EQ(start(file.files), start({}));
}

// Waits until a handler is installed, for a minute at most.
void wait_for_handler(int signal) {
  struct sigaction now {};
  for (int k = 0; k < 3000; ++k) {
    sigaction(signal, nullptr, &now);
    if (now.sa_handler != SIG_DFL) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

TEST_F(LiquidFill, EndsWithinASecondAfterAnInterrupt) {
  using Clock = std::chrono::steady_clock;
  // Some 11,000 particles, for tens of seconds of a core.
  scene_["sph"]["spacing"] = 0.0035;
  for (const int signal : {SIGINT, SIGTERM}) {
    Clock::time_point sent;
    std::thread user([&] {
      wait_for_handler(signal);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      sent = Clock::now();
      kill(getpid(), signal);
    });
    std::string said = "no error";
    try {
      read({"cpu", 1});
    } catch (const Error& error) {
      said = error.what();
      EXPECT_EQ(exit_status(error.code()), 130);
    }
    const Clock::time_point end = Clock::now();
    user.join();
    const double waited = std::chrono::duration<double>(end - sent).count();
    std::printf("ended after %.2f s: %s\n", waited, said.c_str());
    EXPECT_EQ(said, "the run was interrupted while its liquid was filled in");
    EXPECT_LT(waited, 1);
  }
}

}  // namespace liquid_fill_test
}  // namespace tandem::launch
