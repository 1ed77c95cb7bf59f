#include "coordinator/scene/scene_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "coordinator/run/half_steps.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// The message of read_scene() for a text, with and without an override.
class OverriddenScene : public testing::Test {
 protected:
  void SetUp() override {
    file_ = fs::temp_directory_path() / ("tandem_scene_" + std::to_string(getpid()) + ".json");
  }
  void TearDown() override { fs::remove(file_); }
  std::string refusal(const std::string& text, const Overrides& overrides) {
    std::ofstream(file_) << text;
    try {
      read_scene(file_, overrides);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::scene);
      return error.what();
    }
    return "";
  }
  // Refused with the same words, with and without an override.
  void expect_refused(const std::string& text, const std::string& words) {
    Overrides longer, finer;
    longer.end_time = 2;
    finer.window = 1e-3;
    const std::string plain = refusal(text, {});
    EXPECT_NE(plain.find(words), std::string::npos) << plain;
    EXPECT_EQ(refusal(text, longer), plain);
    EXPECT_EQ(refusal(text, finer), plain);
  }
  fs::path file_;
};

TEST_F(OverriddenScene, KeyGivenTwiceIsRefused) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 1, "end_time": 3})", "is given twice");
}

// The limits belong to the laws of the particle solver, and are checked before a program starts.
TEST_F(OverriddenScene, MicroStepAboveTheLimitOfTheLawIsRefused) {
  std::ifstream base(std::string(TANDEM_SOURCE_DIR) + "/tests/system/scenes/hanging_box.json");
  auto json = nlohmann::json::parse(base);
  json["dem"]["micro_step"] = 0.999e-3;
  const std::string plain = refusal(json.dump(), {});
  EXPECT_NE(plain.find("dem.micro_step: the micro step of 0.000999 s is above the stable"), std::string::npos)
      << plain;
  EXPECT_NE(plain.find("0.4 of the Rayleigh time"), std::string::npos) << plain;
}

TEST_F(OverriddenScene, DeepNestingIsRefused) {
  expect_refused(std::string(100000, '['), "nested more than 64 deep");
}

TEST_F(OverriddenScene, CouplingThatIsNoObjectIsRefused) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 1, "coupling": 3})",
                 "coupling: the value is 3");
}

TEST_F(OverriddenScene, ValuesOfAnotherTypeAreRefused) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": "x"})", "end_time: the value is \"x\"");
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 1, "coupling": {"window": [1]}})",
                 "coupling.window: the value is [1]");
}

TEST_F(OverriddenScene, ChecksThatAreLeftOutMustBeRightToo) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 10, "checks": 5})", "checks: the value is 5");
}

TEST_F(OverriddenScene, TextThatIsNoJsonIsRefused) {
  expect_refused(R"({"tandem": "1.1", )", "line 1");
}

// An overridden value has the same bounds as one of the file.
TEST_F(OverriddenScene, OverrideOutOfBoundsIsRefused) {
  Overrides overrides;
  overrides.window = 1e-300;
  const std::string said = refusal(R"({"tandem": "1.1", "name": "a", "end_time": 1})", overrides);
  EXPECT_NE(said.find("coupling.window: the value is 1e-300"), std::string::npos) << said;
}

TEST(SceneFile, FoldersAndDevicesAreNoScenes) {
  const auto refusal = [](const char* path) -> std::string {
    try {
      read_scene(path, {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("/tmp"), "/tmp: is a folder (give the path of a file)");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device (give the path of a file)");
}

// A body of a mesh in a file, a hull that is a wall, and graphics.
class ShapesInFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("tandem_shapes_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write_stl(const TriangleMesh& mesh) {
    std::ofstream file(folder_ / "part.stl");
    file << "solid part\n";
    for (const auto& triangle : mesh.triangles) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (const std::uint32_t v : triangle)
        file << "vertex " << mesh.vertices[v].x << " " << mesh.vertices[v].y << " " << mesh.vertices[v].z
             << "\n";
      file << "endloop\nendfacet\n";
    }
    file << "endsolid part\n";
  }

  SceneFile read() {
    std::ofstream(folder_ / "scene.json")
        << R"({"tandem": "1.1", "name": "a", "end_time": 1, "mbd": {"bodies": [
      {"name": "part", "mass": "from_shapes", "position": [1, 2, 3], "orientation": {"axis": [0, 0, 1], "angle_deg": 90},
       "shapes": [
        {"name": "block", "use": "graphics", "density": 500, "position": [0, 0, 1],
         "shape": {"type": "mesh", "file": "part.stl", "scale": 4, "stretch": [0.5, 0.5, 0.5]}},
        {"name": "roof", "use": "wall", "material": "glass", "density": 0, "position": [0, 0, 3],
         "shape": {"type": "convex_hull", "file": "part.stl"}},
        {"name": "tip", "use": "wall", "material": "glass", "density": 0, "position": [0, 0, 5],
         "shape": {"type": "cone", "radius": 1, "height": 2, "segments": 16}}]}]},
      "dem": {"materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
        "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.3}],
        "walls": [{"name": "side", "body": "part", "material": "glass", "position": [4, 0, 0],
                   "shape": {"type": "mesh", "file": "part.stl", "stretch": [1, 2, 4]}}],
        "particles": [{"name": "g", "material": "glass", "radius": 0.1,
                       "fill": {"type": "lattice", "min": [-5, -5, -5], "max": [-4, -4, -4], "spacing": 0.3}}],
        "domain": {"min": [-9, -9, -9], "max": [9, 9, 9]}}})";
    return read_scene(folder_ / "scene.json");
  }

  fs::path folder_;
};

TEST_F(ShapesInFiles, AreMassesWallsAndGraphics) {
  write_stl(box_mesh({0.5, 0.5, 0.5}));
  const SceneFile file = read();
  const scene::Body& body = file.scene.mbd->bodies[0];
  EXPECT_NEAR(body.mass, 500, 1e-10);
  EXPECT_NEAR(body.inertia[2], 500.0 / 6, 1e-10);
  EXPECT_NEAR(norm(body.pose.p_WB - Vec3d{1, 2, 4}), 0, 1e-14);
  ASSERT_EQ(file.shaped.size(), 1u);
  EXPECT_EQ(file.shaped[0].shapes, 1u);
  // Poses from the centre of mass, which is 1 m above the origin of the body as it is written.
  ASSERT_EQ(file.scene.dem->walls.size(), 3u);
  EXPECT_EQ(file.scene.dem->walls[0].name, "side");
  EXPECT_EQ(file.scene.dem->walls[0].pose.p_WB, (Vec3d{4, 0, -1}));
  EXPECT_EQ(file.scene.dem->walls[1].pose.p_WB, (Vec3d{0, 0, 2}));
  ASSERT_EQ(file.meshes.size(), 3u);
  EXPECT_EQ(file.meshes[0].name, "side");
  for (const Vec3d& v : file.meshes[0].mesh.vertices)
    EXPECT_EQ((Vec3d{std::abs(v.x), std::abs(v.y), std::abs(v.z)}), (Vec3d{0.25, 0.5, 1}));
  EXPECT_EQ(file.meshes[1].name, "roof");
  EXPECT_EQ(file.meshes[1].mesh.triangles.size(), 12u);
  EXPECT_EQ(file.meshes[2].name, "tip");
  EXPECT_EQ(file.mesh_facts.size(), 1u);
  ASSERT_EQ(file.drawn.size(), 1u);
  for (const Vec3d& v : file.drawn[0].mesh.vertices) EXPECT_NEAR(std::abs(v.z), 0.5, 1e-14);
  // What the servers get is a scene of its own.
  const scene::Scene again = scene::parse(file.text, "text");
  EXPECT_TRUE(again.is_plain);
  EXPECT_EQ(again.mbd->bodies[0].mass, body.mass);
  EXPECT_EQ(file.text.find("shapes"), std::string::npos);
  const auto is_of_facets = [](const std::string& note) {
    return note.find("wall \"tip\" is a cone of flat faces, which are up to 0.0192 m inside") == 0;
  };
  EXPECT_EQ(std::count_if(file.notes.begin(), file.notes.end(), is_of_facets), 1);
}

TEST_F(ShapesInFiles, OpenMeshesHaveNoMass) {
  write_stl(box_mesh({0.5, 0.5, 0.5}, {"+z"}));
  try {
    read();
    FAIL() << "an open mesh has a mass";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("mbd.bodies[0].shapes[0].shape: the mesh encloses no volume: the edge from ["),
              what.npos)
        << what;
    EXPECT_NE(what.find("0.5] belongs to one triangle only"), what.npos) << what;
  }
}

// A scene of format 1.0 reaches the solvers as it stands in the file, to the byte.
TEST(SceneText, OfPlainScenesIsUnchanged) {
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(TANDEM_SOURCE_DIR) / "launch/scenes")) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream in(entry.path());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
    if (json.is_discarded() || json.value("tandem", "") != "1.0") continue;
    EXPECT_TRUE(scene::parse(text, entry.path().string()).is_plain) << entry.path();
    EXPECT_EQ(read_scene(entry.path()).text, text) << entry.path();
  }
}

// The second run of --estimate richardson has no spheres in its frames, and nothing that belongs to them.
TEST(HalfSteps, HaveNoFieldsOfSpheresOrWalls) {
  SceneFile file = read_scene(std::string(TANDEM_SOURCE_DIR) + "/tests/system/scenes/hanging_box.json");
  nlohmann::json json = nlohmann::json::parse(file.text);
  json["output"] = {{"fields", {"group"}}, {"wall_fields", {"inside"}}, {"contacts", {"box"}}};
  file.text = json.dump();
  file.scene = scene::parse(file.text, "box.json");
  const SceneFile half = with_half_steps(file);
  EXPECT_NO_THROW(scene::validate(half.scene, "box.json"));
  EXPECT_TRUE(half.scene.output.fields.empty() && half.scene.output.wall_fields.empty() &&
              half.scene.output.contacts.empty());
}

}  // namespace
}  // namespace tandem::launch
