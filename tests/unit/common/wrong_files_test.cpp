// Wrong scenes: the files that they refer to.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene {
namespace {

namespace fs = std::filesystem;

class SceneFiles : public testing::Test {
 protected:
  SceneFiles() : folder_(fs::temp_directory_path() / ("tandem_scene_files_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~SceneFiles() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // The good scene with its spheres from grains.csv.
  static nlohmann::json scene_with_file() {
    auto scene = test::good_scene();
    scene["dem"]["particles"][0]["fill"] = {{"type", "file"}, {"file", "grains.csv"}};
    return scene;
  }

  std::string verdict(const nlohmann::json& document) const {
    try {
      const Scene scene = parse(document.dump(), "scene.json");
      validate(scene, "scene.json");
      validate_files(scene, "scene.json", folder_);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

 private:
  fs::path folder_;
};

TEST_F(SceneFiles, SceneWithoutFilesNeedsNone) {
  EXPECT_EQ(verdict(test::good_scene()), "no error");
}

TEST_F(SceneFiles, MissingMesh) {
  auto scene = test::good_scene();
  scene["dem"]["walls"][0]["shape"] = {{"type", "mesh"}, {"file", "parts/hull.stl"}};
  EXPECT_EQ(verdict(scene),
            "scene.json: dem.walls[0].shape.file: the file of wall 'inside' does not exist: " +
                path("parts/hull.stl") + " (relative names start at the folder of the scene)");
}

TEST_F(SceneFiles, MissingMeshByAbsolutePath) {
  auto scene = test::good_scene();
  scene["dem"]["walls"][0]["shape"] = {{"type", "mesh"}, {"file", "/nowhere/hull.stl"}};
  EXPECT_EQ(
      verdict(scene),
      "scene.json: dem.walls[0].shape.file: the file of wall 'inside' does not exist: /nowhere/hull.stl "
      "(relative names start at the folder of the scene)");
}

TEST_F(SceneFiles, FolderInsteadOfAMesh) {
  auto scene = test::good_scene();
  scene["dem"]["walls"][0]["shape"] = {{"type", "mesh"}, {"file", "."}};
  EXPECT_EQ(verdict(scene), "scene.json: dem.walls[0].shape.file: the file of wall 'inside' is a folder: " +
                                path(".") + " (give the path of a file)");
}

TEST_F(SceneFiles, DeviceInsteadOfParticles) {
  auto scene = scene_with_file();
  scene["dem"]["particles"][0]["fill"]["file"] = "/dev/zero";
  EXPECT_EQ(verdict(scene),
            "scene.json: dem.particles[0].fill.file: the file of group 'grains' is a device: /dev/zero "
            "(give the path of a file)");
}

TEST_F(SceneFiles, MissingParticleFile) {
  EXPECT_EQ(verdict(scene_with_file()),
            "scene.json: dem.particles[0].fill.file: the file of group 'grains' does not exist: " +
                path("grains.csv") + " (relative names start at the folder of the scene)");
}

TEST_F(SceneFiles, RadiusInTheSceneOrInTheFile) {
  auto scene = scene_with_file();
  write("grains.csv", "x,y,z,radius\n0,0,1,0.01\n");
  EXPECT_EQ(verdict(scene), "scene.json: dem.particles[0].radius: the radius is given here and in " +
                                path("grains.csv") + " (keep one of them)");
  scene["dem"]["particles"][0].erase("radius");
  EXPECT_EQ(verdict(scene), "no error");
  write("grains.csv", "x,y,z\n0,0,1\n");
  EXPECT_EQ(verdict(scene), "scene.json: dem.particles[0]: neither the group nor " + path("grains.csv") +
                                " gives a radius (add radius [m])");
}

TEST_F(SceneFiles, VelocityInTheSceneAndInTheFile) {
  write("grains.csv", "x,y,z,vx,vy,vz\n0,0,1,0,0,0\n");
  EXPECT_EQ(verdict(scene_with_file()),
            "scene.json: dem.particles[0].velocity: the velocity is given here and in " + path("grains.csv") +
                " (keep one of them)");
}

TEST_F(SceneFiles, FixedSpheresHaveNoVelocityAndMayBeOutsideTheDomain) {
  auto scene = scene_with_file();
  auto& groups = scene["dem"]["particles"];
  groups[0].erase("velocity");
  auto moving = groups[0];
  moving["name"] = "moving";
  moving["fill"]["file"] = "moving.csv";
  groups.push_back(moving);
  groups[0]["fixed"] = true;
  write("moving.csv", "x,y,z\n0,0,1\n");
  write("grains.csv", "x,y,z,vx,vy,vz\n0,0,1,0,0,0\n");
  EXPECT_EQ(verdict(scene),
            "scene.json: dem.particles[0].fixed: the spheres of a fixed group never move, and " +
                path("grains.csv") +
                " gives velocities (leave out its columns vx,vy,vz and wx,wy,wz, or fixed)");
  write("grains.csv", "x,y,z\n0,0,1\n0,5,1\n");
  EXPECT_EQ(verdict(scene), "no error");
}

TEST_F(SceneFiles, SphereOutsideTheDomain) {
  write("grains.csv", "x,y,z\n0,0,1\n0,5,1\n");
  EXPECT_EQ(verdict(scene_with_file()),
            path("grains.csv") +
                ": sphere 2: the position [0, 5, 1] is outside the domain (enlarge "
                "dem.domain of scene.json)");
}

TEST_F(SceneFiles, FaultInTheParticleFile) {
  write("grains.csv", "x,y,z\n0,0,one\n");
  EXPECT_EQ(verdict(scene_with_file()),
            path("grains.csv") +
                ": line 2: 'one' is not a finite number (give plain decimal numbers between commas)");
}

}  // namespace
}  // namespace tandem::scene
