#include "coordinator/results/body_meshes.hpp"

#include <numbers>

#include "common/error.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += 0.5 * norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
  }
  return sum;
}

scene::Scene plane_scene(Vec3d point, Vec3d normal) {
  scene::Scene scene;
  scene.dem.emplace();
  scene.dem->domain = {{-1, -2, -3}, {1, 2, 3}};
  scene.dem->walls = {
      {.name = "p", .body = ground, .material = {}, .pose = {}, .shape = scene::PlaneShape{point, normal}}};
  return scene;
}

TEST(BodyMeshes, GroundFirstThenBodiesInSceneOrder) {
  const auto meshes = body_meshes(toy::machine(), {});
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[0].body, ground);
  EXPECT_EQ(meshes[0].name, "ground");
  EXPECT_EQ(meshes[1].name, "wheel");
  EXPECT_EQ(meshes[2].name, "rod");
  // Floor of 2 x 2 and five sides of the unit box.
  EXPECT_NEAR(area(meshes[0].mesh), 4 + 5, 1e-12);
}

TEST(BodyMeshes, PlaneFillsTheDomain) {
  EXPECT_NEAR(area(body_meshes(plane_scene({9, 9, 0}, {0, 0, 1}), {})[0].mesh), 2 * 4, 1e-12);
  EXPECT_NEAR(area(body_meshes(plane_scene({0, 0, 0}, {1, 0, 0}), {})[0].mesh), 4 * 6, 1e-12);
}

TEST(BodyMeshes, SlantedPlaneIsAHexagon) {
  auto scene = plane_scene({0, 0, 0}, {1, 1, 1});
  scene.dem->domain = {{-1, -1, -1}, {1, 1, 1}};
  const auto mesh = body_meshes(scene, {})[0].mesh;
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(area(mesh), 3 * std::sqrt(3.0), 1e-12) << "regular hexagon of side sqrt(2)";
}

double round_area(decltype(scene::Wall::shape) shape) {
  auto scene = plane_scene({}, {0, 0, 1});
  scene.dem->walls[0].shape = std::move(shape);
  const auto meshes = body_meshes(scene, {});
  return meshes.empty() ? 0 : area(meshes[0].mesh);
}

TEST(BodyMeshes, RoundWallsAreDrawnFinely) {
  constexpr double pi = std::numbers::pi;
  EXPECT_NEAR(round_area(scene::SphereShape{0.5}), pi, 0.01 * pi);
  EXPECT_NEAR(round_area(scene::CylinderShape{0.5, 2, {}, {"+z"}}), 2.25 * pi, 0.01 * pi);
  // Without ends, as long as the domain extended by a radius.
  EXPECT_NEAR(round_area(scene::CylinderShape{0.5, {}, {}, {}}), 7 * pi, 0.01 * 7 * pi);
}

TEST(BodyMeshes, EndlessCylinderIsDrawnWhereItsAxisPassesTheDomain) {
  auto scene = plane_scene({}, {0, 0, 1});
  scene.dem->walls[0].shape = scene::CylinderShape{0.5, {}, {}, {}};
  scene.dem->walls[0].pose = {{0, 0, 2}, exp({std::numbers::pi / 2, 0, 0})};  // along y
  const auto meshes = body_meshes(scene, {});
  ASSERT_EQ(meshes.size(), 1u);
  for (const Vec3d& v : meshes[0].mesh.vertices) {
    EXPECT_NEAR(std::abs(v.y), 2.5, 1e-12);
    EXPECT_NEAR(std::hypot(v.x, v.z - 2), 0.5, 1e-12);
  }
  scene.dem->walls[0].pose.p_WB.z = 9;
  EXPECT_TRUE(body_meshes(scene, {}).empty());
}

TEST(BodyMeshes, PlaneOutsideTheDomainIsNotDrawn) {
  EXPECT_TRUE(body_meshes(plane_scene({0, 0, 9}, {0, 0, 1}), {}).empty());
}

TEST(BodyMeshes, PlaneOnABodyIsGivenInTheBodyFrame) {
  auto scene = plane_scene({0, 0, 0}, {0, 0, 1});
  scene.mbd.emplace();
  scene.mbd->bodies = {{.name = "b",
                        .mass = 1,
                        .inertia = {1, 1, 1, 0, 0, 0},
                        .pose = {{0, 0, 1}, exp({0, 1, 0})},
                        .twist = {}}};
  scene.dem->walls[0].body = {0};
  const auto mesh = body_meshes(scene, {})[0].mesh;
  for (const Vec3d& vertex : mesh.vertices) EXPECT_NEAR(vertex.z, 0, 1e-12);
}

TEST(BodyMeshes, BodyWithoutWallsIsItsInertiaBox) {
  // 12 kg, edges 1, 2, 3 m: I = (4 + 9, 1 + 9, 1 + 4) kg m2.
  const auto mesh = body_meshes(toy::machine(), {})[2].mesh;
  Vec3d least = mesh.vertices[0], most = mesh.vertices[0];
  for (const Vec3d& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) {
      least[i] = std::min(least[i], v[i]);
      most[i] = std::max(most[i], v[i]);
    }
  }
  const Vec3d edges = most - least;
  EXPECT_NEAR(edges.x, 1, 1e-12);
  EXPECT_NEAR(edges.y, 2, 1e-12);
  EXPECT_NEAR(edges.z, 3, 1e-12);
}

// A body with shapes is not drawn as its inertia, and one with walls has both.
TEST(BodyMeshes, ShapesAreDrawnWithTheWalls) {
  const auto scene = toy::machine();
  const BodyMesh on_wheel{{0}, "spoke", box_mesh({1, 1, 1})}, on_block{{1}, "cover", box_mesh({2, 2, 2})};
  const auto plain = body_meshes(scene, {}), drawn = body_meshes(scene, {}, {on_wheel, on_block});
  ASSERT_EQ(drawn.size(), plain.size());
  EXPECT_NEAR(area(drawn[1].mesh), area(plain[1].mesh) + 6, 1e-12);
  EXPECT_NEAR(area(drawn[2].mesh), 24, 1e-12);
}

// A box of 1 m stands on a plane of contact.
scene::Scene on_plane_of_contact(Vec3d point, Vec3d normal) {
  scene::Scene scene;
  scene.mbd.emplace();
  scene.mbd->bodies = {
      {.name = "b", .mass = 6, .inertia = {1, 1, 1, 0, 0, 0}, .pose = {{0, 0, 0.5}, {}}, .twist = {}}};
  scene.contact.emplace();
  scene::Shape& plane = scene.contact->ground.emplace_back();
  plane.name = "road", plane.use = scene::ShapeUse::contact;
  plane.geometry = scene::PlaneShape{point, normal};
  return scene;
}

// What bodies roll on is drawn: its shapes, and planes below everything else.
TEST(BodyMeshes, ShapesOfContactOfTheGroundAreDrawn) {
  auto scene = on_plane_of_contact({7, 3, 0}, {0, 0, 1});
  const BodyMesh ramp{ground, "ramp", box_mesh({1, 1, 1})};
  const auto meshes = body_meshes(scene, {}, {ramp});
  ASSERT_EQ(meshes.size(), 2u);
  EXPECT_EQ(meshes[0].name, contact_ground);
  EXPECT_EQ(meshes[0].body, ground);
  EXPECT_EQ(meshes[1].name, "b");
  // Body and ramp take 1 x 1 x 1.5 m: a quarter of the diagonal is added on each side.
  const double edge = 1 + 2 * 0.25 * std::sqrt(1 + 1 + 1.5 * 1.5);
  EXPECT_NEAR(area(meshes[0].mesh), 6 + edge * edge, 1e-12);
  for (std::size_t i = 8; i < meshes[0].mesh.vertices.size(); ++i)
    EXPECT_NEAR(meshes[0].mesh.vertices[i].z, 0, 1e-12) << i;
}

TEST(BodyMeshes, AWallOfTheGroundWithAColourIsASurfaceForItself) {
  auto scene = plane_scene({0, 0, 0}, {0, 0, 1});
  scene.dem->walls.push_back(scene.dem->walls.front());
  scene.dem->walls.back().name = "red", scene.dem->walls.back().colour = Vec3d{1, 0, 0};
  const auto meshes = body_meshes(scene, {});
  ASSERT_GE(meshes.size(), 2u);
  EXPECT_EQ(meshes[0].name, "ground");
  EXPECT_EQ(meshes[1].name, "ground.wall.red");
  EXPECT_EQ(meshes[1].body, ground);
  EXPECT_NEAR(area(meshes[0].mesh), area(meshes[1].mesh), 1e-12);
}

TEST(BodyMeshes, PlanesOfContactFarAwayAreNotDrawn) {
  EXPECT_EQ(body_meshes(on_plane_of_contact({0, 0, -10}, {0, 0, 1}), {}).size(), 2u);
  EXPECT_EQ(body_meshes(on_plane_of_contact({0, 0, -30}, {0, 0, 1}), {}).size(), 1u);
}

// In the domain of the particles, 2 x 4 x 6 m here, and not at the same place.
TEST(BodyMeshes, APlaneThatIsAWallAsWellIsDrawnBelowIt) {
  auto scene = on_plane_of_contact({5, 0, 0}, {0, 0, 2});
  scene.dem = plane_scene({0, 0, 0}, {0, 0, 1}).dem;
  auto meshes = body_meshes(scene, {});
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[0].name, "ground");
  EXPECT_EQ(meshes[1].name, contact_ground);
  EXPECT_NEAR(area(meshes[1].mesh), 2 * 4, 1e-12);
  for (const Vec3d& v : meshes[1].mesh.vertices) EXPECT_NEAR(v.z, -1e-4 * std::sqrt(4 + 16 + 36), 1e-12);
  scene.contact->ground[0].geometry = scene::PlaneShape{{0, 0, 0}, {1, 0, 0}};
  meshes = body_meshes(scene, {});
  EXPECT_NEAR(area(meshes[1].mesh), 4 * 6, 1e-12);
  for (const Vec3d& v : meshes[1].mesh.vertices) EXPECT_NEAR(v.x, 0, 1e-12);
}

TEST(BodyMeshes, MeshWallNeedsItsMesh) {
  auto scene = toy::machine();
  scene.dem->walls[0].shape = scene::MeshShape{"wheel.stl", 1};
  EXPECT_THROW(body_meshes(scene, {}), Error);
  protocol::NamedMesh wheel{"rim", box_mesh({1, 1, 1})};
  EXPECT_NEAR(area(body_meshes(scene, {wheel})[1].mesh), 6, 1e-12);
}

}  // namespace
}  // namespace tandem::launch
