// Beds that settle before the start, and their cache.
#include "coordinator/scene/settle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/error.hpp"
#include "common/state_file.hpp"
#include "coordinator/scene/settle_cache.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double radius = 0.01, density = 2500, gravity = 9.81;
constexpr double fall = density * 4 / 3 * std::numbers::pi * radius * radius * radius * gravity * radius;

class Settling : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("tandem_settling_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    setenv("TANDEM_CACHE", (folder_ / "cache").c_str(), 1);
    unsetenv("TANDEM_CACHE_MB");
    scene_ = nlohmann::json::parse(R"({"tandem": "1.1", "name": "bed", "end_time": 0.01,
      "mbd": {"bodies": [{"name": "tray", "mass": 1, "inertia": [1, 1, 1], "position": [0, 0, -0.04]}],
              "joints": [{"name": "slide", "type": "prismatic", "child": "tray", "axis": [1, 0, 0],
                          "position": [0, 0, 0], "damping": 1}]},
      "dem": {"materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25,
                             "restitution": 0.3, "friction": 0.5}],
        "walls": [{"name": "box", "material": "glass", "body": "tray", "position": [0, 0, 0.04],
                   "shape": {"type": "box", "size": [0.08, 0.08, 0.12], "open": ["+z"]}}],
        "particles": [{"name": "grains", "material": "glass", "radius": 0.01,
                       "fill": {"type": "packing", "region": {"type": "inside", "wall": "box"}, "count": 40}}],
        "domain": {"min": [-0.2, -0.2, -0.2], "max": [0.2, 0.2, 0.2]}}})");
    scene_["dem"]["settle"] = {{"kinetic_energy", 1e-3 * fall}};
  }
  void TearDown() override {
    unsetenv("TANDEM_CACHE");
    unsetenv("TANDEM_CACHE_MB");
    fs::remove_all(folder_);
  }

  SceneFile read(const SettleOn& on = {}) {
    std::ofstream(folder_ / "scene.json") << scene_.dump();
    return read_scene(folder_ / "scene.json", {}, on);
  }
  std::string refusal() {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  std::vector<fs::path> beds() const {
    std::vector<fs::path> files;
    if (fs::exists(folder_ / "cache"))
      for (const auto& entry : fs::directory_iterator(folder_ / "cache")) files.push_back(entry.path());
    return files;
  }

  fs::path folder_;
  nlohmann::json scene_;
};

TEST_F(Settling, SpheresComeToRestAndTheSecondStartHasTheSameBits) {
  const SceneFile first = read({"cpu", 1});
  ASSERT_TRUE(first.settled);
  EXPECT_FALSE(first.settled->from_cache);
  EXPECT_LT(first.settled->kinetic_energy, 1e-3 * fall);
  EXPECT_GT(first.settled->time, std::sqrt(2 * radius / gravity));
  EXPECT_FALSE(first.scene.dem->settle);
  ASSERT_EQ(first.placed.size(), 1u);
  EXPECT_EQ(first.placed[0].spheres, 40u);
  ASSERT_EQ(first.files.size(), 1u);
  const scene::ParticleFile bed = scene::read_particle_file(first.files[0].text, "bed");
  ASSERT_EQ(bed.positions.size(), 40u);
  ASSERT_EQ(bed.spins.size(), 40u);
  double lowest = 1, highest = -1;
  for (const Vec3d& p : bed.positions) {
    lowest = std::min(lowest, p.z);
    highest = std::max(highest, p.z);
    EXPECT_LE(std::max(std::abs(p.x), std::abs(p.y)), 0.03 + 0.01 * radius);
  }
  EXPECT_NEAR(lowest, -0.06 + radius, 0.01 * radius);
  std::printf("settled in %g s to %.3g of the energy of a fall, top at %g m\n", first.settled->time,
              first.settled->kinetic_energy / fall, highest + radius);

  const SceneFile second = read({"cpu", 2});
  EXPECT_TRUE(second.settled->from_cache);
  EXPECT_EQ(second.text, first.text);
  EXPECT_EQ(second.files[0].text, first.files[0].text);
  EXPECT_EQ(second.settled->time, first.settled->time);
  EXPECT_EQ(second.placed[0].void_fraction, first.placed[0].void_fraction);
  EXPECT_THAT(second.log, Contains(HasSubstr("taken from the cache")));

  setenv("TANDEM_CACHE", "off", 1);
  const SceneFile anew = read({"cpu", 2});
  EXPECT_FALSE(anew.settled->from_cache);
  EXPECT_EQ(anew.files[0].text, first.files[0].text);
}

TEST_F(Settling, DamagedBedIsNamedAndMadeAnew) {
  const SceneFile first = read();
  ASSERT_EQ(beds().size(), 1u);
  const fs::path bed = beds()[0];
  const auto size = static_cast<std::streamoff>(fs::file_size(bed));
  std::fstream file(bed, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(size / 2);
  const auto byte = static_cast<char>(file.get() ^ 1);
  file.seekp(size / 2).put(byte);
  file.close();
  const SceneFile second = read();
  EXPECT_FALSE(second.settled->from_cache);
  EXPECT_EQ(second.files[0].text, first.files[0].text);
  EXPECT_THAT(second.log, Contains(AllOf(HasSubstr("is not used, and is made anew"), HasSubstr(bed.string()),
                                         HasSubstr("damaged"))));
  EXPECT_TRUE(read().settled->from_cache);
}

TEST_F(Settling, BedIsMadeAnewOnlyForWhatItFollowsFrom) {
  const auto changed = [&](const std::function<void(nlohmann::json&)>& change) {
    const nlohmann::json given = scene_;
    change(scene_);
    const bool is_anew = !read().settled->from_cache;
    scene_ = given;
    return is_anew;
  };
  read();
  EXPECT_FALSE(changed([](nlohmann::json& scene) { scene["end_time"] = 0.02; }));
  EXPECT_FALSE(changed([](nlohmann::json& scene) { scene["mbd"]["joints"][0]["damping"] = 2; }));
  EXPECT_FALSE(changed([](nlohmann::json& scene) { scene["mbd"]["bodies"][0]["mass"] = 2; }));
  EXPECT_FALSE(changed([](nlohmann::json& scene) { scene["output"]["frame_interval"] = 0.01; }));
  EXPECT_FALSE(changed([](nlohmann::json& scene) {
    scene["dem"]["outlets"] = nlohmann::json::parse(
        R"([{"name": "far", "region": {"type": "box", "min": [0.1, 0.1, 0.1], "max": [0.2, 0.2, 0.2]}}])");
  }));
  EXPECT_TRUE(changed([](nlohmann::json& scene) { scene["mbd"]["bodies"][0]["position"][2] = -0.041; }));
  EXPECT_TRUE(changed([](nlohmann::json& scene) { scene["dem"]["materials"][0]["friction"] = 0.4; }));
  EXPECT_TRUE(changed([](nlohmann::json& scene) { scene["dem"]["particles"][0]["fill"]["seed"] = 2; }));
  EXPECT_TRUE(changed([](nlohmann::json& scene) { scene["dem"]["settle"]["kinetic_energy"] = 2e-3 * fall; }));
}

TEST_F(Settling, GroupsOfAllFillsSettleAndKeepTheirNames) {
  scene_["dem"]["particles"].push_back(
      nlohmann::json::parse(R"({"name": "more", "material": "glass", "radius": 0.005,
    "fill": {"type": "lattice", "min": [-0.03, -0.03, 0.03], "max": [0.03, 0.03, 0.05], "spacing": 0.012}})"));
  scene_["dem"]["particles"].push_back(
      nlohmann::json::parse(R"({"name": "rain", "material": "glass", "radius": 0.005,
    "fill": {"type": "inlet", "min": [-0.03, -0.03, 0.1], "max": [0.03, 0.03, 0.12], "rate": 1000}})"));
  const SceneFile file = read();
  ASSERT_EQ(file.placed.size(), 2u);
  EXPECT_EQ(file.placed[1].group, "more");
  EXPECT_EQ(file.placed[1].from, "lattice");
  EXPECT_EQ(file.files.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<scene::FileFill>(file.scene.dem->particles[1].fill));
  EXPECT_TRUE(std::holds_alternative<scene::InletFill>(file.scene.dem->particles[2].fill));
  EXPECT_TRUE(read().settled->from_cache);
}

TEST_F(Settling, WhatDoesNotSettleIsRefused) {
  scene_["dem"]["settle"]["kinetic_energy"] = 0.2 * fall;
  EXPECT_THAT(refusal(), AllOf(HasSubstr("dem.settle: the kinetic_energy of"),
                               HasSubstr("does not tell a bed at rest from falling spheres"),
                               HasSubstr("give at most a tenth of that")));
  scene_["dem"]["settle"] = {{"kinetic_energy", 1e-3 * fall}, {"at_most", 0.05}};
  EXPECT_THAT(refusal(),
              AllOf(HasSubstr("dem.settle: the spheres have not settled after 0.05 s"),
                    HasSubstr("; 21 of 40 spheres have more than that, from ["),
                    HasSubstr("; the fastest is sphere "), HasSubstr(" of 'grains' at ["),
                    HasSubstr(" m from wall 'box' of 'tray'"), HasSubstr("give more time as at_most")));
  scene_["dem"]["settle"].erase("at_most");
  scene_["dem"]["walls"][0]["shape"]["open"] = {"-z"};
  EXPECT_THAT(refusal(),
              AllOf(HasSubstr("spheres have left the domain by t = "), HasSubstr("; the first is sphere "),
                    HasSubstr(" of 'grains', last seen at ["), HasSubstr("near the face z = -0.2 m"),
                    HasSubstr("close the container for the start")));
  EXPECT_TRUE(beds().empty());
}

CachedBed bed_of(std::size_t spheres) {
  CachedBed bed;
  bed.settled.groups = {"grains"};
  bed.settled.spheres.push_back({std::vector<Vec3d>(spheres), std::vector<double>(spheres, 0.1),
                                 std::vector<Vec3d>(spheres), std::vector<Vec3d>(spheres)});
  return bed;
}

TEST_F(Settling, CacheRemovesWhatWasNotUsedForTheLongestTime) {
  const SettleCache cache(folder_ / "cache", 1000000);  // room for two beds of 400 kB
  const SettleKey keys[] = {{"one"}, {"two"}, {"three"}, {"four"}};
  std::vector<std::string> log;
  const auto now = fs::file_time_type::clock::now();
  for (int k = 0; k < 2; ++k) {
    cache.keep(keys[k], bed_of(4000), log);
    fs::last_write_time(folder_ / "cache" / keys[k].name(), now - std::chrono::hours(3 - k));
  }
  EXPECT_TRUE(cache.find(keys[0], log));  // is now the newer one
  log.clear();
  cache.keep(keys[2], bed_of(4000), log);
  EXPECT_THAT(log, Contains(AllOf(HasSubstr("the cache is full"), HasSubstr(keys[1].name()))));
  EXPECT_TRUE(cache.find(keys[0], log));
  EXPECT_FALSE(cache.find(keys[1], log));
  EXPECT_TRUE(cache.find(keys[2], log));
  cache.keep(keys[3], bed_of(20000), log);
  EXPECT_THAT(log, Contains(HasSubstr("is not kept: the cache has 1 MB")));
  EXPECT_TRUE(cache.find(keys[0], log));
}

TEST_F(Settling, BedThatOthersMayHaveWrittenIsNotUsed) {
  const mode_t usual = umask(0);
  read();
  umask(usual);
  ASSERT_EQ(beds().size(), 1u);
  const fs::path cache = folder_ / "cache", bed = beds()[0];
  EXPECT_TRUE(read().settled->from_cache) << "whatever the umask was";
  const auto not_used = [&](const std::string& why) {
    const SceneFile file = read();
    EXPECT_FALSE(file.settled->from_cache) << why;
    EXPECT_THAT(file.log, Contains(AllOf(HasSubstr("is not used, and is made anew"), HasSubstr(why))));
  };
  fs::permissions(bed, fs::perms::others_write, fs::perm_options::add);
  not_used("can be written by other users: delete it");
  fs::permissions(cache, fs::perms::group_write, fs::perm_options::add);
  not_used("chmod go-w it");
  fs::permissions(cache, fs::perms::sticky_bit, fs::perm_options::add);
  EXPECT_TRUE(read().settled->from_cache) << "nobody else can replace a file there";
  fs::rename(bed, folder_ / "bed.h5");
  fs::create_symlink(folder_ / "bed.h5", bed);
  not_used("is not a plain file");
  if (geteuid() != 0) return;
  ASSERT_EQ(chown(bed.c_str(), 65534, 65534), 0);
  not_used("belongs to another user (uid 65534)");
  ASSERT_EQ(chown(cache.c_str(), 65534, 65534), 0);
  not_used("belongs to another user (uid 65534)");
}

TEST_F(Settling, BedThatIsNotOfTheSceneIsNotUsed) {
  scene_["dem"]["particles"].push_back(
      nlohmann::json::parse(R"({"name": "more", "material": "glass", "radius": 0.005,
    "fill": {"type": "lattice", "min": [-0.03, -0.03, 0.03], "max": [0.03, 0.03, 0.05], "spacing": 0.012}})"));
  read();
  const std::vector<fs::path> files = beds();
  ASSERT_EQ(files.size(), 1u);
  const auto forged = [&](const std::function<void(CachedBed&)>& forge) {
    // The key is in the file itself.
    const std::string key = StateReader(files[0], "settled bed", 1).text("key");
    const SettleCache cache(folder_ / "cache", 1000000);
    std::vector<std::string> log;
    const std::optional<CachedBed> right = cache.find({key}, log);
    CachedBed bed = right.value();
    forge(bed);
    cache.keep({key}, bed, log);
    const SceneFile file = read();
    EXPECT_FALSE(file.settled->from_cache);
    std::string said = "none";
    for (const std::string& line : file.log)
      if (line.find("is not used") != std::string::npos) said = line;
    return said;
  };
  EXPECT_TRUE(read().settled->from_cache);
  EXPECT_THAT(forged([](CachedBed& bed) { bed.settled.spheres[0].radii[3] = 0.008; }),
              HasSubstr("has a sphere with the radius 0.008 m, and the scene gives 0.01 to 0.01 m"));
  EXPECT_THAT(forged([](CachedBed& bed) { bed.settled.spheres[1].radii[3] = 0.004; }),
              HasSubstr("its group 'more' has other radii"));
  EXPECT_THAT(forged([](CachedBed& bed) { bed.settled.spheres[0].positions[3].x = 1; }),
              HasSubstr("its sphere 3 is not in the domain"));
  EXPECT_THAT(forged([](CachedBed& bed) { bed.settled.spheres[0].velocities[3].x = 1; }),
              HasSubstr("its mean kinetic energy is"));
  EXPECT_THAT(forged([](CachedBed& bed) { bed.settled.groups[0] = "others"; }),
              HasSubstr("it lacks the group 'grains'"));
  EXPECT_THAT(forged([](CachedBed& bed) { bed.placed[0].mass *= 2; }), HasSubstr("its figures of the group"));
  EXPECT_THAT(forged([](CachedBed& bed) {
                for (auto* rows : {&bed.settled.spheres[0].positions, &bed.settled.spheres[0].velocities,
                                   &bed.settled.spheres[0].spins})
                  rows->pop_back();
                bed.settled.spheres[0].radii.pop_back();
              }),
              HasSubstr("its group 'grains' has 39 spheres, and the scene 40"));
}

TEST_F(Settling, CacheInAFolderWithOtherFilesRemovesOnlyItsOwn) {
  fs::create_directories(folder_ / "cache");
  for (const char* name : {"draft_of_my_thesis", "settled_score.h5", "draft_12_settled_"})
    std::ofstream(folder_ / "cache" / name) << "mine";
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(100);
  for (const fs::path& file : beds()) fs::last_write_time(file, old);
  std::vector<std::string> log;
  const SettleCache cache(folder_ / "cache", 1000000);
  for (const char* key : {"one", "two", "three", "four"}) cache.keep({key}, bed_of(4000), log);
  EXPECT_EQ(beds().size(), 5u) << "three of the user, and the two that have room";
}

TEST_F(Settling, CacheThatCannotBeWrittenDoesNotEndTheRun) {
  std::ofstream(folder_ / "cache") << "no folder";
  const SceneFile file = read();
  EXPECT_FALSE(file.settled->from_cache);
  EXPECT_THAT(file.log, Contains(HasSubstr("the settled bed is not kept")));
}

TEST_F(Settling, LimitOfTheCacheMustBeANumber) {
  setenv("TANDEM_CACHE_MB", "2 GB", 1);
  EXPECT_THAT(refusal(),
              HasSubstr("TANDEM_CACHE_MB: the value is '2 GB' (give a whole number of megabytes)"));
}

}  // namespace
}  // namespace tandem::launch
