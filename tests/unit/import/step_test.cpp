// STEP files: exact mass properties, meshes, proposed joints, and refusals. tests/unit/import/step has the
// script that made the files.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "coordinator/mesh_import/mesh_facts.hpp"
#include "launch/import/model_format.hpp"
#include "launch/import/step_child.hpp"
#include "launch/import/step_scene.hpp"
#include "tests/unit/import/model_folder.hpp"

namespace tandem::launch {
namespace step_files {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double mm = 1e-3, inch = 25.4e-3;
const std::filesystem::path files = TANDEM_SOURCE_DIR "/tests/unit/import/step";

class Step : public ModelFolder {
 protected:
  void SetUp() override {
    if (step_reader().empty()) GTEST_SKIP() << "this build reads no STEP files: OpenCASCADE was not found";
    ModelFolder::SetUp();
  }
  ImportOptions of(const std::string& name) const {
    ImportOptions options;
    options.model = files / name;
    options.output = folder_ / "m.json";
    return options;
  }
  // The message of the error, without the folders.
  std::string refusal(const std::filesystem::path& file, const ImportOptions& given = {}) const {
    ImportOptions options = given;
    options.model = file;
    options.output = folder_ / "m.json";
    try {
      if (format_of(file) == ModelFormat::step) import_step(options);
    } catch (const Error& error) {
      std::string text = error.what();
      for (const std::string& path : {folder_.string() + "/", files.string() + "/"})
        for (std::size_t at; (at = text.find(path)) != std::string::npos;) text.erase(at, path.size());
      return text;
    }
    return "imported";
  }
};

// Solids of density 1 that are added, and with -1 cut out [mm].
MassProperties block(Vec3d low, Vec3d high, double sign = 1) {
  return placed(mass_of_box(mm * (high - low), sign), {0.5 * mm * (low + high), {}});
}
MassProperties rod(char axis, double radius, Vec3d begin, double length, double sign = 1) {
  const double half = std::sqrt(0.5);
  const Quat q = axis == 'z' ? Quat{} : axis == 'y' ? Quat{half, half, 0, 0} : Quat{half, 0, half, 0};
  Vec3d middle = begin;
  middle[axis - 'x'] += 0.5 * length;
  return placed(mass_of_cylinder(radius * mm, length * mm, sign), {mm * middle, q});
}

const StepProduct& product_of(const StepFile& step, const std::string& name) {
  for (const StepPart& part : step.parts)
    if (part.name() == name) return step.products[part.product];
  throw std::runtime_error("no part " + name);
}

double worst = 0;  // relative difference so far

void expect_exact(const StepProduct& product, const std::vector<MassProperties>& solids) {
  SCOPED_TRACE(product.name);
  const MassProperties expected = sum(solids);
  const auto differ = [](double found, double wanted, double scale) {
    worst = std::max(worst, std::abs(found - wanted) / scale);
    EXPECT_NEAR(found, wanted, 1e-6 * scale);
  };
  differ(product.unit.mass, expected.mass, expected.mass);
  const double trace = expected.inertia[0] + expected.inertia[1] + expected.inertia[2];
  for (int k = 0; k < 3; ++k) differ(product.unit.centre[k], expected.centre[k], product.size());
  for (std::size_t k = 0; k < 6; ++k) differ(product.unit.inertia[k], expected.inertia[k], trace);
}

TEST_F(Step, MassPropertiesAgreeWithClosedForms) {
  const StepFile crank = read_step(files / "slider_crank.step", {});
  EXPECT_EQ(crank.parts.size(), 8u);
  EXPECT_EQ(crank.products.size(), 7u);  // the two bolts are one shape
  expect_exact(product_of(crank, "frame"),
               {block({-120, -60, -120}, {420, 130, -100}), block({120, -40, -100}, {400, 40, -20}),
                block({120, -40, -20}, {400, -20, 20}), block({120, 20, -20}, {400, 40, 20}),
                rod('z', 5, {-45, 90, -120}, 20, -1), rod('z', 5, {45, 90, -120}, 20, -1)});
  expect_exact(product_of(crank, "bearing_block"),
               {block({-30, 70, -100}, {30, 110, 40}), block({-60, 70, -100}, {-30, 110, -85}),
                block({30, 70, -100}, {60, 110, -85}), rod('y', 15, {0, 70, 0}, 40, -1),
                rod('z', 5, {-45, 90, -100}, 15, -1), rod('z', 5, {45, 90, -100}, 15, -1)});
  expect_exact(product_of(crank, "bolt_1"), {rod('z', 5, {0, 0, -35}, 35), rod('z', 9, {}, 8)});
  expect_exact(product_of(crank, "crank"), {rod('y', 15, {0, 70, 0}, 50), rod('y', 20, {0, 60, 0}, 10),
                                            block({-20, 40, -20}, {70, 60, 20}),
                                            rod('y', 16, {50, 10, 0}, 30), rod('y', 10, {50, -14, 0}, 24)});
  expect_exact(product_of(crank, "slider"),
               {block({-30, -20, -20}, {30, 20, 20}), block({-30, -10, -20}, {16, 10, 20}, -1),
                rod('y', 8, {0, -20, 0}, 10, -1), rod('y', 8, {0, 10, 0}, 10, -1)});
  expect_exact(product_of(crank, "gudgeon_pin"), {rod('y', 8, {0, -18, 0}, 36)});

  const StepFile bucket = read_step(files / "bucket_inch.step", {});
  EXPECT_EQ(bucket.unit, "INCH");
  const double in = inch / mm;
  expect_exact(product_of(bucket, "weight"),
               {block({-5 * in, -24 * in, 10 * in}, {5 * in, -20 * in, 13 * in}),
                rod('y', in, {2 * in, -24 * in, 11.5 * in}, 4 * in, -1)});

  const StepFile gearbox = read_step(files / "gearbox.step", {});
  EXPECT_EQ(gearbox.parts.size(), 60u);
  EXPECT_EQ(gearbox.products.size(), 8u);
  expect_exact(product_of(gearbox, "gear_1"),
               {rod('y', 50, {0, -10, 0}, 20), rod('y', 15, {0, -10, 0}, 20, -1)});
  expect_exact(product_of(gearbox, "bearing_1"), {rod('y', 30, {}, 15), rod('y', 15, {}, 15, -1)});
  expect_exact(product_of(gearbox, "shaft"), {rod('y', 15, {0, -110, 0}, 220)});
  std::printf("  largest relative difference %.1e (limit 1e-6)\n", worst);
}

// The pole of a ball and the apex of a cone are an edge of one point each, for all parameters along it.
TEST_F(Step, BallsConesAndTorusesAgreeWithClosedForms) {
  worst = 0;
  const StepFile step = read_step(files / "rounds.step", {});
  const auto round = [](double mass, Vec3d centre, double across, double along) {
    MassProperties solid;
    solid.mass = mass, solid.centre = mm * centre;
    solid.inertia = {across, across, along, 0, 0, 0};
    return solid;
  };
  const double dome = 2.0 / 3 * std::numbers::pi * std::pow(15 * mm, 3), dome2 = dome * std::pow(15 * mm, 2);
  const double torus = 2 * std::pow(std::numbers::pi, 2) * 30 * 100 * mm * mm * mm, square = mm * mm;
  expect_exact(product_of(step, "ball"), {mass_of_sphere(25 * mm, 1)});
  expect_exact(product_of(step, "bearing_ball"), {mass_of_sphere(2 * mm, 1)});
  expect_exact(product_of(step, "cone"),
               {placed(mass_of_cone(20 * mm, 0, 50 * mm, 1), {{0, 0, 25 * mm}, {}})});
  expect_exact(product_of(step, "dome"),
               {round(dome, {0, 0, 15 * 3 / 8.0}, 83.0 / 320 * dome2, 0.4 * dome2)});
  expect_exact(product_of(step, "torus"), {round(torus, {}, torus * square * (900 / 2.0 + 500 / 8.0),
                                                 torus * square * (900 + 300 / 4.0))});
  std::printf("  largest relative difference %.1e (limit 1e-6)\n", worst);
  // By the distance of points of the mesh from the surface.
  const auto deepest = [&](const char* name, const auto& distance) {
    const StepProduct& product = product_of(step, name);
    double most = 0;
    for (const auto& [i, j, k] : product.mesh.triangles) {
      const Vec3d a = product.mesh.vertices[i], b = product.mesh.vertices[j], c = product.mesh.vertices[k];
      for (const Vec3d x : {1.0 / 3 * (a + b + c), 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)})
        most = std::max(most, std::abs(distance(x)));
    }
    std::printf("  %s: %zu triangles, %.2e m from the surface, measured %.2e, stated %.2e\n", name,
                product.mesh.triangles.size(), most, product.deviation, product.stated_deviation);
    EXPECT_LE(most, product.stated_deviation + 1e-8);
    EXPECT_GT(most, 0.3 * product.deviation);
  };
  deepest("ball", [](Vec3d x) { return norm(x) - 25 * mm; });
  deepest("bearing_ball", [](Vec3d x) { return norm(x) - 2 * mm; });
  deepest("torus", [](Vec3d x) { return std::hypot(std::hypot(x.x, x.y) - 30 * mm, x.z) - 10 * mm; });
  deepest("cone", [](Vec3d x) {
    const double across = (20 * mm * (1 - x.z / (50 * mm)) - std::hypot(x.x, x.y)) * 50 / std::hypot(50, 20);
    return std::min(across, x.z);
  });
}

TEST_F(Step, MeshesAreClosedAndWithinTheirDeviation) {
  for (const char* name : {"slider_crank.step", "bucket_inch.step", "gearbox.step", "rounds.step"})
    for (const StepProduct& product : read_step(files / name, 0.0004).products) {
      SCOPED_TRACE(product.name);
      const MeshFacts facts = facts_of(product.mesh);
      EXPECT_LE(product.deviation, 0.0004);
      ASSERT_TRUE(facts.volume.has_value());
      EXPECT_NEAR(*facts.volume, product.unit.mass,
                  facts.area * product.deviation + 1e-6 * product.unit.mass);
    }
  // Of the pin, by its radius: no point of the mesh is farther inside than stated.
  const StepFile step = read_step(files / "slider_crank.step", 2e-5);
  const TriangleMesh& pin = product_of(step, "gudgeon_pin").mesh;
  double deepest = 0;
  for (const auto& [i, j, k] : pin.triangles)
    for (const Vec3d x : {1.0 / 3 * (pin.vertices[i] + pin.vertices[j] + pin.vertices[k]),
                          0.5 * (pin.vertices[i] + pin.vertices[j])})
      if (std::abs(x.y) < 17.9 * mm) deepest = std::max(deepest, 8 * mm - std::hypot(x.x, x.z));
  std::printf("  pin: %.2e m inside (limit 2e-5)\n", deepest);
  EXPECT_GT(deepest, 1e-6);
  EXPECT_LE(deepest, 2e-5 + 1e-9);
}

TEST_F(Step, SliderCrankHasExactlyItsTrueJoints) {
  ImportOptions options = of("slider_crank.step");
  options.materials = {"steel"};
  options.fuse_smaller_than = 0.06;
  options.ground = {"frame"};
  options.joints = true;
  const Imported imported = import_step(options);
  std::vector<std::string> found;
  for (const auto& joint : imported.scene["mbd"]["joints"])
    found.push_back(joint["type"].get<std::string>() + " " + joint["parent"].get<std::string>() + " " +
                    joint["child"].get<std::string>());
  EXPECT_THAT(found, testing::UnorderedElementsAre("fixed ground frame", "fixed frame bearing_block",
                                                   "revolute bearing_block crank", "revolute crank rod",
                                                   "revolute rod slider", "prismatic frame slider"));
  const double x = 50 * mm * std::cos(std::numbers::pi / 3), z = 50 * mm * std::sin(std::numbers::pi / 3);
  const std::map<std::string, Vec3d> points{{"bearing_block_crank", {0, 0.08, 0}},
                                            {"crank_rod", {x, 0.005, z}},
                                            {"rod_slider", {x + std::sqrt(0.04 - z * z), 0, 0}}};
  std::size_t checked = 0;
  for (const auto& joint : imported.scene["mbd"]["joints"])
    if (const auto point = points.find(joint["name"]); point != points.end()) {
      ++checked;
      EXPECT_NEAR(joint["position"][0].get<double>(), point->second.x, 1e-9);
      EXPECT_NEAR(joint["position"][2].get<double>(), point->second.z, 1e-9);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(joint["axis"][k].get<double>(), k == 1 ? 1 : 0, 1e-9);
      }
    }
  EXPECT_EQ(checked, 3u);
  EXPECT_EQ(imported.files.size(), 7u);
}

TEST_F(Step, WithoutFusingTheBoltsAreJointsOfTheirOwn) {
  ImportOptions options = of("slider_crank.step");
  options.materials = {"steel"};
  const Imported imported = import_step(options);
  EXPECT_EQ(imported.scene["mbd"]["bodies"].size(), 8u);
  EXPECT_FALSE(imported.scene["mbd"].contains("joints"));  // never without --joints
  EXPECT_THAT(imported.tables, HasSubstr("bolt_1"));
  EXPECT_THAT(imported.tables, HasSubstr("proposed joints; --joints writes"));
}

TEST_F(Step, AssembliesMergeAndDensitiesGoByPattern) {
  ImportOptions options = of("gearbox.step");
  options.materials = {"*=steel", "housing=aluminium"};
  options.densities = {"plug*=1000"};
  options.merge = {"housing", "train_?"};
  const Imported imported = import_step(options);
  const auto& bodies = imported.scene["mbd"]["bodies"];
  std::vector<std::string> names;
  for (const auto& body : bodies) names.push_back(body["name"]);
  EXPECT_THAT(names, ElementsAre("housing", "train_1", "train_2", "train_3", "plug_1", "plug_2"));
  EXPECT_NEAR(bodies[4]["mass"].get<double>(), 1000 * std::numbers::pi * 64 * 6 * 1e-9, 1e-9);
  // The train: symmetric about its axis but for rings and keys; mass of all its parts.
  const double steel = 7850e-9 * std::numbers::pi;
  const double train =
      steel * (15 * 15 * 220 + 3 * (2500 - 225) * 20 + 2 * (900 - 225) * 15 + 4 * (289 - 225) * 2) +
      7850e-9 * 4 * 4 * 16 * 4;
  EXPECT_NEAR(bodies[1]["mass"].get<double>(), train, 1e-6 * train);
}

TEST_F(Step, PartsWithReservedNamesAreRenamedAndNamed) {
  std::ifstream in(files / "gearbox.step");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const auto& [part, reserved] : {std::pair{"'plug_1'", "'time'"}, {"'plug_2'", "'ground'"}})
    for (std::size_t at; (at = text.find(part)) != std::string::npos;) text.replace(at, 8, reserved);
  put("reserved.step", text);
  ImportOptions options = of("gearbox.step");
  options.model = folder_ / "reserved.step";
  options.materials = {"steel"};
  options.merge = {"housing", "train_?"};
  const Imported imported = import_step(options);
  std::vector<std::string> names;
  for (const auto& body : imported.scene["mbd"]["bodies"]) names.push_back(body["name"]);
  EXPECT_THAT(names, ElementsAre("housing", "train_1", "train_2", "train_3", "time_1", "ground_1"));
  EXPECT_THAT(
      imported.notes,
      ElementsAre("renamed: the body of part 'time' is 'time_1', because 'time' is a reserved name",
                  "renamed: the body of part 'ground' is 'ground_1', because 'ground' is a reserved name"));
}

TEST_F(Step, BodiesHaveTheirColoursAndAssemblies) {
  ImportOptions options = of("slider_crank.step");
  options.materials = {"steel"};
  const auto crank = import_step(options).scene["mbd"]["bodies"];
  // Color(0.3, 0.3, 0.3) and Color(0.1, 0.3, 0.8) of make_step_files.py, in steps of 1/255.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(crank[0]["color"][k].get<double>(), 0.3, 0.5 / 255 + 1e-12);
  EXPECT_NEAR(crank[1]["color"][0].get<double>(), 0.1, 0.5 / 255 + 1e-12);
  EXPECT_NEAR(crank[1]["color"][2].get<double>(), 0.8, 0.5 / 255 + 1e-12);
  EXPECT_EQ(crank[0]["assembly"], "slider_crank");
  options = of("gearbox.step");
  options.materials = {"steel"};
  const auto gearbox = import_step(options).scene["mbd"]["bodies"];
  EXPECT_EQ(gearbox[0]["assembly"], "gearbox/housing");
  EXPECT_EQ(gearbox[2]["assembly"], "gearbox/housing/bolts");
  EXPECT_FALSE(gearbox[0].contains("color"));
}

TEST_F(Step, IntoASceneWithParticlesMeshesAreWalls) {
  put("bed.json", R"({"tandem": "1.1", "name": "bed", "end_time": 1, "dem": {
    "materials": [{"name": "hard", "density": 8000, "young": 1e7, "poisson": 0.3, "restitution": 0.5, "friction": 0.3}],
    "particles": [], "domain": {"min": [-9,-9,-9], "max": [9,9,9]}}})");
  ImportOptions options = of("slider_crank.step");
  options.into = folder_ / "bed.json";
  options.materials = {"hard"};
  const Imported imported = import_step(options);
  const auto& pin = imported.scene["mbd"]["bodies"][7];
  EXPECT_NEAR(pin["mass"].get<double>(), 8000 * std::numbers::pi * 64 * 36e-9, 1e-9);
  EXPECT_EQ(pin["shapes"][0]["use"], "wall");
  EXPECT_EQ(pin["shapes"][0]["material"], "hard");
  options.materials = {"*=hard", "crank=soft"};
  EXPECT_THAT(refusal(files / "slider_crank.step", options), HasSubstr("soft"));
}

// Copies at one place would all be compared with each other.
TEST(StepFaces, AMillionPairsOfPartsThatLieInEachOtherAreRefused) {
  StepFile step;
  StepProduct& cube = step.products.emplace_back();
  cube.name = "cube";
  cube.unit = mass_of_box({1, 1, 1}, 1);
  cube.mesh = box_mesh({1, 1, 1});
  cube.low = {-0.5, -0.5, -0.5}, cube.high = {0.5, 0.5, 0.5};
  for (int k = 0; k < 1500; ++k) step.parts.push_back({{"cube" + std::to_string(k)}, 0, {}, {}, {}});
  try {
    fitting_faces(step, "huge.step");
    ADD_FAILURE() << "compared";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("huge.step: more than 1000000 pairs of its 1500 parts are so near that "
                          "they may touch, such as 'cube"));
  }
  for (int k = 0; k < 1500; ++k) step.parts[static_cast<std::size_t>(k)].pose.p_WB.x = 1.5 * k;
  EXPECT_TRUE(fitting_faces(step, "row.step").empty());
}

TEST_F(Step, RefusesWhatIsNoSolidMachine) {
  const auto write = [&](const std::string& name, const std::string& text) {
    put(name, text);
    return folder_ / name;
  };
  std::ifstream in(files / "gearbox.step");
  std::string whole{std::istreambuf_iterator<char>(in), {}};
  ImportOptions steel;
  steel.materials = {"steel"};
  EXPECT_EQ(
      refusal(files / "surface.step", steel),
      "surface.step: no part has a solid, only surfaces or curves (export solids: a mass needs a volume)");
  EXPECT_THAT(refusal(write("cut.step", whole.substr(0, whole.size() / 2)), steel), HasSubstr("cut.step: "));
  std::string garbled = whole;
  for (std::size_t i = 5000; i < garbled.size(); i += 97) garbled[i] = static_cast<char>('!' + i % 90);
  EXPECT_THAT(refusal(write("garbled.step", garbled), steel), HasSubstr("garbled.step: "));
  EXPECT_EQ(refusal(write("empty.step", "")),
            "empty.step: is empty (export it again, as AP203, AP214 or AP242)");
  EXPECT_THAT(refusal(write("header.step", "ISO-10303-21;\n")), HasSubstr("header.step: "));
  EXPECT_THAT(refusal(files / "slider_crank.step"), HasSubstr("8 of 8 parts have no density"));
  ImportOptions wrong = steel;
  wrong.ground = {"frmae"};
  EXPECT_THAT(refusal(files / "slider_crank.step", wrong),
              HasSubstr("--ground: no part or assembly is named 'frmae'"));
  wrong = steel;
  wrong.materials = {"*=stel"};
  EXPECT_THAT(refusal(files / "slider_crank.step", wrong),
              HasSubstr("there is no material 'stel' in the library"));
  wrong.materials = {"water"};
  EXPECT_EQ(
      refusal(files / "slider_crank.step", wrong),
      "--material: 'water' is a liquid, which no body can be of (give a solid of docs/materials.md, such as "
      "--material steel, or the density of the part, as in --density 'tank*=1000')");
}

// The screw of the package occt-misc, from the numbers of its file [mm]: a shank with a chamfer, a
// countersunk head with a pointed dome, and a slot through the head. The sections across the axis are discs,
// above the bottom of the slot less a strip; what they have to the strip are integrals of closed form, and
// those along the axis are summed by Simpson's rule.
MassProperties screw() {
  constexpr double bottom = -34.56367, chamfer = -33.64357, neck = 0.43633, slot = 2.93633, rim = 5.43633;
  constexpr double half = 1.25, dome_radius = 54.873718663856, dome_at = -46.31367, dome_off = 8.25;
  const double top = dome_at + std::sqrt(dome_radius * dome_radius - std::pow(half + dome_off, 2));
  const auto radius = [&](double z) {
    if (z < chamfer) return 4.0799 + z - bottom;
    if (z < neck) return 5.0;
    if (z < rim) return 5 + z - neck;
    return std::sqrt(dome_radius * dome_radius - std::pow(z - dome_at, 2)) - dome_off;
  };
  double volume = 0, first = 0, xx = 0, yy = 0, zz = 0;  // integrals of 1, z and squares
  const auto add = [&](double z, double weight) {
    const double r = radius(z), r2 = r * r;
    double area = std::numbers::pi * r2, x2 = area * r2 / 4, y2 = x2;
    if (z >= slot) {
      const double s = std::sqrt(std::max(0.0, r2 - half * half)), angle = std::asin(std::min(1.0, half / r));
      area -= 2 * (half * s + r2 * angle);
      y2 -= 4 * (r2 * r2 / 8 * angle - half / 8 * (r2 - 2 * half * half) * s);
      x2 -= 4.0 / 3 * (half / 8 * (5 * r2 - 2 * half * half) * s + 3.0 / 8 * r2 * r2 * angle);
    }
    volume += weight * area, first += weight * z * area;
    xx += weight * x2, yy += weight * y2, zz += weight * z * z * area;
  };
  for (const auto& [from, to] :
       {std::pair{bottom, chamfer}, {chamfer, neck}, {neck, slot}, {slot, rim}, {rim, top}}) {
    constexpr int intervals = 20000;
    const double step = (to - from) / intervals;
    for (int i = 0; i <= intervals; ++i) {
      const double rounding = (i == 0 ? 1e-12 : i == intervals ? -1e-12 : 0) * (to - from);
      add(from + i * step + rounding, step / 3 * (i == 0 || i == intervals ? 1 : i % 2 == 1 ? 4 : 2));
    }
  }
  const double height = first / volume, along = zz - first * height;  // about the centre
  MassProperties mass;
  mass.mass = volume * 1e-9;
  mass.centre = mm * Vec3d{-17.89811369191, -0.826297072243, height};
  mass.inertia = {(yy + along) * 1e-15, (xx + along) * 1e-15, (xx + yy) * 1e-15, 0, 0, 0};
  return mass;
}

TEST_F(Step, AForeignScrewAgreesWithItsClosedForm) {
  const std::filesystem::path file = "/usr/share/opencascade/data/step/screw.step";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not installed";
  worst = 0;
  const StepProduct product = read_step(file, {}).products.at(0);
  expect_exact(product, {screw()});
  std::printf("  volume %.9e m3, expected %.9e; largest relative difference %.1e (limit 2e-7)\n",
              product.unit.mass, screw().mass, worst);
  EXPECT_LE(worst, 2e-7);  // the numbers of the file have so many digits
}

// The rods have free-form faces, and faces that meet within 4e-7 m only: of two meshes, whose error is that
// of their area per triangle, to the limit of infinitely many triangles.
TEST_F(Step, ForeignRodsHaveTheMassPropertiesThatTheirMeshesTendTo) {
  const std::filesystem::path file = "/usr/share/opencascade/data/step/linkrods.step";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not installed";
  const StepProduct coarse = read_step(file, 4e-6).products.at(0),
                    fine = read_step(file, 1e-6).products.at(0);
  const MassProperties one = mass_of_mesh(coarse.mesh, 1), other = mass_of_mesh(fine.mesh, 1);
  const auto more = 1 / (static_cast<double>(fine.mesh.triangles.size()) /
                             static_cast<double>(coarse.mesh.triangles.size()) -
                         1);
  const auto limit = [&](double first, double second) { return second + more * (second - first); };
  const MassProperties& exact = fine.unit;
  std::printf("  volume %.6e m3, of meshes %.6e, %.6e and their limit %.6e\n", exact.mass, one.mass,
              other.mass, limit(one.mass, other.mass));
  EXPECT_NEAR(limit(one.mass, other.mass), exact.mass, 1e-4 * exact.mass);
  EXPECT_GT(exact.mass - other.mass, 2e-4 * exact.mass);  // so that the limit says more than the mesh
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(limit(one.centre[k], other.centre[k]), exact.centre[k], 1e-5 * fine.size());
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(limit(one.inertia[k], other.inertia[k]), exact.inertia[k], 2e-4 * exact.inertia[2]);
}

TEST(ModelFormat, OtherFormatsAreRefusedByName) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const auto refusal = [&](const std::string& name, const std::string& text) -> std::string {
    const std::filesystem::path file = folder / (std::to_string(getpid()) + name);
    std::ofstream(file) << text;
    try {
      format_of(file);
    } catch (const Error& error) {
      std::filesystem::remove(file);
      return error.problem();
    }
    return "read";
  };
  EXPECT_THAT(refusal("a.igs", "x"), HasSubstr("is IGES"));
  EXPECT_THAT(refusal("a.txt", std::string(72, ' ') + "S      1\n"), HasSubstr("is neither STEP"));
  EXPECT_THAT(refusal("a.dat", "IGES" + std::string(68, ' ') + "S      1\n"), HasSubstr("is IGES"));
  EXPECT_THAT(refusal("a.stl", "solid"), HasSubstr("is a mesh"));
  EXPECT_THAT(refusal("a.txt", "hello"), HasSubstr("is neither STEP"));
}

}  // namespace step_files
}  // namespace tandem::launch
