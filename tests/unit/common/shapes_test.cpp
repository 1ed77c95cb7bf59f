// Shapes of bodies, and masses that follow from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "common/geometry/solid_mesh.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/plain_text.hpp"
#include "common/scene/shape_mass.hpp"
#include "common/scene/shape_mesh.hpp"
#include "tests/support/error_of.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

json shape(const std::string& name, const json& geometry, const json& more = json::object()) {
  json all{{"name", name}, {"use", "graphics"}, {"density", 1000}, {"shape", geometry}};
  all.update(more);
  return all;
}

const json cube{{"type", "box"}, {"size", {1, 1, 1}}};
const json ball{{"type", "sphere"}, {"radius", 0.5}};

// The good scene with a body 'crate' of these shapes.
json with_shapes(const json& shapes) {
  json scene = test::good_scene();
  json& body = scene["mbd"]["bodies"][0];
  body["mass"] = "from_shapes";
  body.erase("inertia");
  body["shapes"] = shapes;
  return scene;
}

struct Shaped {
  Scene scene;
  std::vector<ShapedBody> bodies;
  std::vector<std::string> warnings;
};

Shaped shaped(const json& document, const std::vector<TriangleMesh>& in_files = {}) {
  Shaped result;
  result.scene = parse(document.dump(), "scene.json");
  validate(result.scene, "scene.json");
  std::vector<TriangleMesh> meshes(result.scene.shapes.size());
  // The good scene has three walls, none with a file.
  std::copy(in_files.begin(), in_files.end(), meshes.begin() + 3);
  result.bodies = take_mass_from_shapes(result.scene, meshes, "scene.json", result.warnings);
  return result;
}

TEST(Shapes, EveryGeometry) {
  const json scene = with_shapes({
      shape("box", cube),
      shape("ball", ball),
      shape("can", {{"type", "cylinder"}, {"radius", 1}, {"height", 2}, {"segments", 7}}),
      shape("pill", {{"type", "capsule"}, {"radius", 1}, {"height", 2}}),
      shape("tip",
            {{"type", "cone"},
             {"radius", 1},
             {"top_radius", 0.5},
             {"height", 2},
             {"segments", 9},
             {"open", {"+z"}}},
            {{"density", 0}}),
      shape("stone", {{"type", "convex_hull"}, {"points", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}),
      shape("scan", {{"type", "convex_hull"}, {"file", "scan.stl"}, {"scale", 0.001}}),
      shape("part", {{"type", "mesh"}, {"file", "part.obj"}, {"scale", 0.01}}),
      shape("hill",
            {{"type", "height_field"}, {"size", {2, 1}}, {"heights", {{1, 2, 3}, {4, 5, 6}}}, {"base", 0}}),
  });
  const Scene parsed = parse(scene.dump(), "scene.json");
  ASSERT_EQ(parsed.shapes.size(), 12u);
  const auto* all = &parsed.shapes[3];
  EXPECT_EQ(std::get<BoxShape>(all[0].geometry).size, (Vec3d{1, 1, 1}));
  EXPECT_EQ(std::get<SphereShape>(all[1].geometry).radius, 0.5);
  EXPECT_EQ(std::get<CylinderShape>(all[2].geometry).segments, 7);
  EXPECT_EQ(std::get<CapsuleShape>(all[3].geometry).height, 2);
  EXPECT_EQ(std::get<ConeShape>(all[4].geometry).top_radius, 0.5);
  EXPECT_EQ(std::get<ConeShape>(all[4].geometry).segments, 9);
  EXPECT_EQ(std::get<ConeShape>(all[4].geometry).open, (std::vector<std::string>{"+z"}));
  EXPECT_EQ(std::get<HullShape>(all[5].geometry).points[3], (Vec3d{0, 0, 1}));
  EXPECT_EQ(file_of(all[6].geometry), "scan.stl");
  EXPECT_EQ(scale_of(all[6].geometry), 0.001);
  EXPECT_EQ(std::get<MeshShape>(all[7].geometry).file, "part.obj");
  const auto& hill = std::get<HeightFieldShape>(all[8].geometry);
  EXPECT_EQ(hill.size_x, 2);
  EXPECT_EQ(hill.heights[1][2], 6);
  EXPECT_EQ(hill.base, 0.0);
  EXPECT_EQ(all[8].path, "mbd.bodies[0].shapes[8]");
  EXPECT_EQ(all[0].density, 1000);
  // Walls of dem.walls are shapes as well.
  EXPECT_EQ(parsed.shapes[0].name, "inside");
  EXPECT_EQ(parsed.shapes[0].use, ShapeUse::wall);
  EXPECT_EQ(parsed.shapes[0].path, "dem.walls[0]");
  EXPECT_EQ(parsed.dem->walls.size(), 3u);
}

// Two spheres at a distance: a dumbbell. The body's origin moves to its centre of mass, and its wall with it.
TEST(MassFromShapes, Dumbbell) {
  json scene =
      with_shapes({shape("big", ball, {{"density", 2000}}), shape("small", ball, {{"position", {3, 0, 0}}})});
  scene["mbd"]["bodies"][0]["orientation"] = {{"axis", {0, 0, 1}}, {"angle_deg", 90}};
  scene["dem"]["sensors"] = {
      {{"name", "content"}, {"body", "crate"}, {"position", {0, 0, 2}}, {"shape", cube}}};
  const auto [result, bodies, warnings] = shaped(scene);
  EXPECT_THAT(warnings, IsEmpty());
  const double m = 1000 * std::numbers::pi / 6, sphere = 0.4 * 0.25 * 3 * m;
  const Body& body = result.mbd->bodies[0];
  EXPECT_NEAR(body.mass, 3 * m, 1e-12 * m);
  EXPECT_NEAR(body.inertia[0], sphere, 1e-12 * m);
  EXPECT_NEAR(body.inertia[1], sphere + 6 * m, 1e-12 * m);  // reduced mass 2 m / 3 at a distance of 3
  EXPECT_NEAR(norm(body.pose.p_WB - Vec3d{0, 1, 1}), 0, 1e-14);
  EXPECT_FALSE(body.from_shapes);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0].shapes, 2u);
  EXPECT_NEAR(norm(bodies[0].mass.centre - Vec3d{1, 0, 0}), 0, 1e-14);
  EXPECT_EQ(result.dem->walls[0].pose.p_WB, (Vec3d{-1, 0, 0.1}));
  EXPECT_EQ(result.dem->walls[2].pose.p_WB, (Vec3d{0, 0, 0}));  // of another body
  EXPECT_EQ(result.dem->sensors[0].pose.p_WB, (Vec3d{-1, 0, 2}));
}

TEST(MassFromShapes, MaterialsAndShapesWithoutMass) {
  const auto mass = [](const json& more) {
    json box = shape("box", cube, more);
    if (more.contains("material") && !more.contains("density")) box.erase("density");
    return shaped(with_shapes({box, shape("nothing", ball, {{"density", 0}})})).scene.mbd->bodies[0].mass;
  };
  EXPECT_NEAR(mass({{"material", "steel"}}), 7800, 1e-9);
  EXPECT_NEAR(mass({{"material", "steel"}, {"density", 10}}), 10, 1e-12);
  EXPECT_NEAR(mass(json::object()), 1000, 1e-10);
}

TEST(MassFromShapes, MeshesAndHulls) {
  const json file{{"type", "mesh"}, {"file", "part.stl"}},
      hull{{"type", "convex_hull"}, {"file", "part.stl"}};
  const TriangleMesh box = transformed(box_mesh({1, 2, 3}), {{1000, 2000, 0}, {}});
  for (const json& geometry : {file, hull}) {
    const Body body = shaped(with_shapes(json::array({shape("part", geometry)})), {box}).scene.mbd->bodies[0];
    EXPECT_NEAR(body.mass, 6000, 1e-7);
    EXPECT_NEAR(body.inertia[0], 500 * 13, 1e-6);
    EXPECT_NEAR(norm(body.pose.p_WB - Vec3d{1000, 2000, 1}), 0, 1e-9);
  }
  const auto open = [&] {
    shaped(with_shapes(json::array({shape("part", file)})), {box_mesh({1, 2, 3}, {"+z"})});
  };
  EXPECT_THAT(
      tandem::test::error_of(open),
      AllOf(HasSubstr("mbd.bodies[0].shapes[0].shape: the mesh encloses no volume: the edge from [-0.5, "),
            HasSubstr("1.5] belongs to one triangle only: the surface is open there (close it in the "
                      "program that made it, or give \"density\": 0)")));
  const json flat{{"type", "convex_hull"}, {"points", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}};
  EXPECT_THAT(tandem::test::error_of([&] { shaped(with_shapes(json::array({shape("sheet", flat)}))); }),
              HasSubstr("mbd.bodies[0].shapes[0].shape: the points of the hull lie in one plane"));
}

// Round shapes with segments weigh what their polyhedron weighs.
TEST(MassFromShapes, SegmentsArePrisms) {
  const json can{{"type", "cylinder"}, {"radius", 1}, {"height", 2}, {"segments", 4}};
  EXPECT_NEAR(shaped(with_shapes(json::array({shape("can", can)}))).scene.mbd->bodies[0].mass, 4000, 1e-9);
}

TEST(MassFromShapes, OverlapsAreReported) {
  const auto warnings = [](double distance, const json& other) {
    return shaped(with_shapes({shape("a", cube), shape("b", other, {{"position", {distance, 0, 0}}})}))
        .warnings;
  };
  EXPECT_THAT(warnings(1, cube), IsEmpty());
  EXPECT_THAT(warnings(0.75, cube),
              ElementsAre(AllOf(HasSubstr("shapes \"a\" and \"b\" of body \"crate\" overlap in some 0.25 m3"),
                                HasSubstr("counts twice"))));
  EXPECT_THAT(warnings(1, ball), IsEmpty());
  EXPECT_THAT(warnings(0.9, ball), testing::SizeIs(1));
  const json tip{{"type", "cone"}, {"radius", 0.5}, {"height", 1}};
  EXPECT_THAT(warnings(0.8, tip), testing::SizeIs(1));
  EXPECT_THAT(warnings(1.01, tip), IsEmpty());
  const json three = {shape("a", cube), shape("b", cube), shape("c", cube)};
  EXPECT_THAT(
      shaped(with_shapes(three)).warnings,
      ElementsAre(HasSubstr("overlap in some 1 m3, and so do 2 other pairs of its shapes; their mass")));
}

TEST(MassFromShapes, PartsOfAMeshThatPassThroughEachOtherAreReported) {
  TriangleMesh cross = box_mesh({1, 0.2, 0.2});
  const TriangleMesh arm = box_mesh({0.2, 1, 0.2});
  for (const auto& [i, j, k] : arm.triangles) cross.triangles.push_back({i + 8, j + 8, k + 8});
  cross.vertices.insert(cross.vertices.end(), arm.vertices.begin(), arm.vertices.end());
  const json file{{"type", "mesh"}, {"file", "part.stl"}};
  EXPECT_THAT(
      shaped(with_shapes(json::array({shape("part", file)})), {cross}).warnings,
      ElementsAre(HasSubstr("parts of the mesh of shape \"part\" of body \"crate\" pass through each other "
                            "in some 0.00")));
  EXPECT_THAT(shaped(with_shapes(json::array({shape("part", file)})), {arm}).warnings, IsEmpty());
}

// The same body in any frame: the principal moments and the centre in the world stay.
TEST(MassFromShapes, AnyFrame) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  const auto machine = [](const json& frame) {
    json scene = with_shapes(
        {shape("a", cube), shape("b", ball, {{"position", {0, 2, 1}}}),
         shape("c", {{"type", "cone"}, {"radius", 0.3}, {"height", 2}}, {{"position", {1, 1, 1}}})});
    scene["mbd"]["bodies"][0].update(frame);
    for (json& part : scene["mbd"]["bodies"][0]["shapes"]) part["relative_to"] = "ground";
    return shaped(scene).scene.mbd->bodies[0];
  };
  const Body still = machine({{"position", {0, 0, 0}}});
  for (int trial = 0; trial < 10; ++trial) {
    const Quat q = Quat{normal(random), normal(random), normal(random), normal(random)}.normalized();
    const double far = trial < 5 ? 1 : 1e3;
    const Body moved =
        machine({{"position", {far * normal(random), far, 0}}, {"orientation", {q.w, q.x, q.y, q.z}}});
    EXPECT_NEAR(moved.mass / still.mass, 1, 1e-12);
    EXPECT_NEAR(norm(moved.pose.p_WB - still.pose.p_WB), 0, 1e-12 * far);
    const MassProperties back = placed({moved.mass, {}, moved.inertia}, {{}, q});
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(back.inertia[i] / still.mass, still.inertia[i] / still.mass, 1e-12 * far);
  }
}

TEST(PlainText, IsWhatSolversKnow) {
  json document = with_shapes(
      {shape("a", cube, {{"use", "wall"}, {"material", "steel"}, {"position", {2, 0, 0}}}), shape("b", ball),
       shape("c", {{"type", "cone"}, {"radius", 0.5}, {"height", 1}, {"segments", 8}},
             {{"use", "wall"}, {"material", "glass"}})});
  document["mbd"]["bodies"][0]["shapes"][1]["density"] = 0;
  document["mbd"]["bodies"][0]["shapes"][2]["density"] = 0;
  document["mbd"]["bodies"][0]["orientation"] = {{"euler_deg", {10, 20, 30}}, {"order", "xyz"}};
  document["dem"]["sensors"] = {
      {{"name", "content"}, {"body", "crate"}, {"position", {2, 0, 0}}, {"shape", cube}}};
  const Scene before = shaped(document).scene;
  const std::string text = plain_text(document.dump(), before, "scene.json");
  const Scene after = parse(text, "scene.json");
  validate(after, "scene.json");
  EXPECT_TRUE(after.is_plain);
  EXPECT_EQ(after.mbd->bodies[0].mass, before.mbd->bodies[0].mass);
  EXPECT_EQ(after.mbd->bodies[0].inertia, before.mbd->bodies[0].inertia);
  EXPECT_EQ(after.mbd->bodies[0].pose.p_WB, before.mbd->bodies[0].pose.p_WB);
  ASSERT_EQ(after.dem->walls.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(after.dem->walls[i].name, before.dem->walls[i].name);
    EXPECT_EQ(after.dem->walls[i].body, before.dem->walls[i].body);
    EXPECT_EQ(after.dem->walls[i].material, before.dem->walls[i].material);
    EXPECT_EQ(after.dem->walls[i].pose.p_WB, before.dem->walls[i].pose.p_WB);
    EXPECT_EQ(after.dem->walls[i].shape.index(), before.dem->walls[i].shape.index());
  }
  EXPECT_NEAR(norm(after.dem->walls[3].pose.p_WB), 0, 1e-15);
  EXPECT_NEAR(norm(after.dem->sensors[0].pose.p_WB), 0, 1e-15);
  EXPECT_EQ(std::get<MeshShape>(after.dem->walls[4].shape).file, "facets of wall c");
  EXPECT_THAT(text, testing::Not(HasSubstr("shapes")));
  // A program that gets the scene as it stands in the file refuses it.
  EXPECT_NO_THROW(expect_masses(after, "scene.json"));
  EXPECT_THAT(
      tandem::test::error_of([&] { expect_masses(parse(document.dump(), "scene.json"), "scene.json"); }),
      HasSubstr("mbd.bodies[0].mass: the mass of 'crate' follows from its shapes, which this program does "
                "not do (send the scene in the plain form, as tandem does)"));
}

TEST(Shapes, DeviationOfFacets) {
  const auto deviation = [](const Geometry& geometry) { return deviation_of_facets(geometry); };
  EXPECT_EQ(deviation(ConeShape{1, 0, 1, {}, {}}), 0);
  EXPECT_NEAR(deviation(ConeShape{1, 0, 1, 4, {}}), 1 - std::sqrt(0.5), 1e-15);
  // No point of the polyhedron is farther inside, and some are nearly as far.
  const CapsuleShape capsule{1, 2, 16};
  double farthest = 0;
  const TriangleMesh mesh = capsule_mesh(1, 2, 16);
  for (const auto& [i, j, k] : mesh.triangles)
    for (double u = 0; u <= 1; u += 0.05)
      for (double v = 0; u + v <= 1; v += 0.05) {
        const Vec3d p = mesh.vertices[i] + u * (mesh.vertices[j] - mesh.vertices[i]) +
                        v * (mesh.vertices[k] - mesh.vertices[i]);
        const double beyond = std::fmax(0, std::abs(p.z) - 1);
        farthest = std::fmax(farthest, 1 - std::hypot(p.x, p.y, beyond));
      }
  EXPECT_LE(farthest, deviation(capsule));
  EXPECT_GT(farthest, 0.8 * deviation(capsule));
}

}  // namespace
}  // namespace tandem::scene
