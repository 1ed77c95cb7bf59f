// Ten bad meshes of known solids: what is found, and what repair makes of them. Coarsening to a stated
// deviation.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "common/geometry/coarse_mesh.hpp"
#include "launch/mesh_tools/mesh_check.hpp"
#include "launch/mesh_tools/mesh_repair.hpp"

namespace tandem::launch {
namespace mesh_tools_test {

using testing::HasSubstr;

const TriangleMesh cube = box_mesh({1, 1, 1});
const TriangleMesh ball = sphere_mesh(1, 48);

TriangleMesh with(TriangleMesh mesh, const TriangleMesh& other, Vec3d by = {}) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3d& v : other.vertices) mesh.vertices.push_back(v + by);
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  return mesh;
}

// Every triangle with corners of its own.
TriangleMesh soup_of(const TriangleMesh& mesh, double shift) {
  TriangleMesh soup;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : mesh.triangles[t])
      soup.vertices.push_back(mesh.vertices[v] + Vec3d{t % 2 == 0 ? shift : 0, 0, 0});
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

struct BadMesh {
  const char* name;
  TriangleMesh mesh;
  double volume;     // of the solid that is meant [m3]
  double tolerance;  // of the volume [m3]
  double moves;      // bound of the deviation [m]
  const char* said;  // part of what repair says
};

std::vector<BadMesh> bad_meshes() {
  const double volume_of_ball = *facts_of(ball).volume;
  std::vector<BadMesh> all;
  TriangleMesh mesh = cube;
  mesh.triangles.pop_back();
  all.push_back({"a triangle is missing", mesh, 1, 1e-12, 0.5, "1 openings filled"});
  mesh = cube;
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  all.push_back({"a triangle is flipped", mesh, 1, 1e-12, 1e-12, "1 triangles turned"});
  mesh = cube;
  mesh.triangles.push_back(mesh.triangles[3]);
  all.push_back({"a triangle is there twice", mesh, 1, 1e-12, 1e-12, "1 duplicate triangles"});
  mesh = cube;
  mesh.triangles.push_back({0, 1, 1});
  all.push_back({"a triangle has no area", mesh, 1, 1e-12, 1e-12, "1 triangles without area"});
  mesh = cube;
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  all.push_back({"inside out", mesh, 1, 1e-12, 1e-12, "1 closed part turned outwards"});
  all.push_back({"corners are not joined", soup_of(cube, 1e-6), 1, 1e-5, 2e-6, "corners joined"});
  // The lower half has a corner in the middle of an edge of the upper one.
  TriangleMesh halves;
  halves = with(
      box_mesh({1, 1, 1}, {"+z"}),
      TriangleMesh{{{-0.5, -0.5, 0.5}, {0, -0.5, 0.5}, {0.5, -0.5, 0.5}, {0.5, 0.5, 0.5}, {-0.5, 0.5, 0.5}},
                   {{0, 1, 4}, {1, 3, 4}, {1, 2, 3}}});
  all.push_back({"a corner lies on an edge", halves, 1, 1e-12, 1e-12, "1 triangles divided"});
  all.push_back({"both ends are open", cylinder_mesh(1, 1, 64, {"-z", "+z"}),
                 0.5 * 64 * std::sin(2 * std::numbers::pi / 64), 1e-9, 1.1, "2 openings filled"});
  mesh = ball;
  mesh.triangles.erase(mesh.triangles.begin() + 500, mesh.triangles.begin() + 502);
  mesh.triangles.erase(mesh.triangles.begin() + 100, mesh.triangles.begin() + 101);
  all.push_back({"a ball with holes", mesh, volume_of_ball, 2e-3, 0.1, "openings filled"});
  mesh = soup_of(ball, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 7)
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.triangles.erase(mesh.triangles.begin() + 300);
  all.push_back({"all of it", mesh, volume_of_ball, 2e-3, 0.1, "corners joined"});
  return all;
}

TEST(MeshRepair, TenBadMeshesBecomeWatertight) {
  std::printf("  %-26s %12s %12s %10s\n", "mesh", "volume", "expected", "moved");
  for (const BadMesh& bad : bad_meshes()) {
    SCOPED_TRACE(bad.name);
    EXPECT_FALSE(faults_of(bad.mesh).is_sound());
    const RepairedMesh result = repaired(bad.mesh, {});
    const MeshFaults left = faults_of(result.mesh);
    EXPECT_TRUE(left.is_sound()) << report_of(left, bad.name);
    ASSERT_TRUE(left.facts.volume.has_value());
    std::printf("  %-26s %12.9f %12.9f %10.2g\n", bad.name, *left.facts.volume, bad.volume, result.deviation);
    EXPECT_NEAR(*left.facts.volume, bad.volume, bad.tolerance);
    EXPECT_LE(result.deviation, bad.moves);
    std::string said;
    for (const std::string& line : result.done) said += line + "\n";
    EXPECT_THAT(said, HasSubstr(bad.said));
  }
}

// What was repaired is coarsened within a hundredth of the size, and stays watertight.
TEST(MeshCoarsen, TenRepairedMeshesStayWatertight) {
  constexpr double deviation = 0.01;
  std::printf("  %-26s %9s %9s %12s %12s %10s\n", "mesh", "triangles", "remain", "volume", "change", "moved");
  for (const BadMesh& bad : bad_meshes()) {
    SCOPED_TRACE(bad.name);
    const TriangleMesh before = repaired(bad.mesh, {}).mesh;
    const CoarseMesh coarse = coarsened(before, deviation);
    const MeshFaults left = faults_of(coarse.mesh);
    EXPECT_TRUE(left.is_sound()) << report_of(left, bad.name);
    ASSERT_TRUE(left.facts.volume.has_value());
    const double moved = distance_between(before, coarse.mesh), volume = *facts_of(before).volume;
    std::printf("  %-26s %9zu %9zu %12.9f %+12.2e %10.2g\n", bad.name, before.triangles.size(),
                coarse.mesh.triangles.size(), *left.facts.volume, *left.facts.volume / volume - 1, moved);
    EXPECT_LE(coarse.mesh.triangles.size(), before.triangles.size());
    EXPECT_LE(moved, 1.05 * deviation);
    EXPECT_NEAR(*left.facts.volume / volume, 1, 0.01);
  }
}

TEST(MeshRepair, ASoundMeshStaysAndWideOpeningsMay) {
  const RepairedMesh same = repaired(ball, {});
  EXPECT_TRUE(same.done.empty());
  EXPECT_EQ(same.mesh.triangles, ball.triangles);
  EXPECT_LE(same.deviation, 1e-14);
  const RepairedMesh open = repaired(cylinder_mesh(1, 1, 64, {"+z"}), {.weld = {}, .fill = 0.5});
  EXPECT_THAT(open.done, testing::ElementsAre("1 openings left as they are"));
}

TEST(MeshCheck, FindsSelfIntersectionsAndSlivers) {
  const MeshFaults crossed = faults_of(with(cube, cube, {0.5, 0.4, 0.3}));
  EXPECT_GT(crossed.intersections, 0u);
  EXPECT_THAT(report_of(crossed, "x.stl"), HasSubstr("self-intersections"));
  EXPECT_EQ(faults_of(with(cube, cube, {1.5, 0, 0})).intersections, 0u);
  EXPECT_EQ(faults_of(ball).intersections, 0u);
  EXPECT_TRUE(faults_of(ball).is_sound());
  const TriangleMesh sliver{{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(faults_of(sliver).slivers, 1u);
}

// All crossings are exactly on edges, and touching is none.
TEST(MeshCheck, FindsTrianglesThatGoThroughEdgesOfOthers) {
  // Across the diagonal of a square, from 0.2 to 0.8 of it, and at its ends.
  const TriangleMesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto blade = [](Vec3d middle, Vec3d half) {
    return TriangleMesh{{middle - half, middle + half, middle - half + Vec3d{0, 0, 9}}, {{0, 1, 2}}};
  };
  EXPECT_EQ(faults_of(with(square, blade({0.5, 0.5, -0.5}, {0.3, -0.3, 0}))).intersections, 2u);
  EXPECT_EQ(faults_of(with(square, blade({0.5, 0.5, 0}, {0.3, -0.3, 0}))).intersections, 0u);  // stands on it
  // Cubes that are moved along a face, and along an edge, of each other.
  EXPECT_GT(faults_of(with(cube, cube, {0.5, 0.5, 0})).intersections, 0u);
  EXPECT_GT(faults_of(with(cube, cube, {0.5, 0.25, 0})).intersections, 0u);
  for (const Vec3d touching : {Vec3d{1, 0, 0}, {1, 0.5, 0.5}, {1, 1, 0}, {1, 1, 1}, {1, 1, 0.5}})
    EXPECT_EQ(faults_of(with(cube, cube, touching)).intersections, 0u) << touching.y << touching.z;
  // A plate between two rings of a tube: one edge of the tube in its plane, triangles above and below.
  const TriangleMesh wall{{{0.2, 0.1, 0}, {0.4, 0.1, 0}, {0.3, 0.1, 1}, {0.3, 0.1, -1}},
                          {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(faults_of(with(square, wall)).intersections, 1u);
  const TriangleMesh roof{{{0.2, 0.1, 0}, {0.4, 0.1, 0}, {0.3, 0.0, 1}, {0.3, 0.2, 1}},
                          {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(faults_of(with(square, roof)).intersections, 0u);
  // Two ridges that cross, one upside down on the other.
  const TriangleMesh ridge{{{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}}, {{0, 1, 2}, {1, 0, 3}}},
      trough{{{0, -1, 0}, {0, 1, 0}, {-1, 0, 1}, {1, 0, 1}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(faults_of(with(ridge, trough)).intersections, 0u);
  EXPECT_EQ(faults_of(with(ridge, trough, {0, 0, -0.1})).intersections, 4u);
}

// Sides that are flush, or sides that face each other: an area of one plane belongs to both.
TEST(MeshCheck, NamesTrianglesThatLieOnEachOther) {
  for (const Vec3d by : {Vec3d{0.5, 0, 0}, {1, 0.5, 0.5}, {0, 0.25, 0.5}}) {
    const std::string report = report_of(faults_of(with(cube, cube, by)), "x.stl");
    EXPECT_THAT(report, HasSubstr("has faults"));
    EXPECT_THAT(report, HasSubstr("lie on each other"));
  }
  EXPECT_TRUE(faults_of(with(cube, cube, {1.5, 0, 0})).is_sound());
  EXPECT_TRUE(faults_of(with(cube, cube, {1, 1, 0})).is_sound());  // along an edge
  EXPECT_TRUE(faults_of(ball).is_sound());
}

TriangleMesh turned(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

TEST(MeshRepair, EachClosedPartTurnsOutwardsButCavitiesInwards) {
  const TriangleMesh small = box_mesh({0.4, 0.4, 0.4}), tiny = box_mesh({0.2, 0.2, 0.2});
  struct Case {
    TriangleMesh mesh;
    double volume;
    std::vector<std::string> done;
  };
  const double cavity = 1 - 0.064;
  for (const Case& c :
       {Case{with(turned(cube), turned(cube), {2, 0, 0}), 2, {"2 closed parts turned outwards"}},
        Case{with(cube, turned(cube), {2, 0, 0}), 2, {"1 closed part turned outwards"}},
        Case{with(cube, turned(small)), cavity, {}},
        Case{with(turned(cube), small), cavity, {"1 closed part turned outwards", "1 cavity turned inwards"}},
        Case{with(with(turned(cube), small), turned(tiny)),
             cavity + 0.008,
             {"2 closed parts turned outwards", "1 cavity turned inwards"}}}) {
    const RepairedMesh result = repaired(c.mesh, {});
    const MeshFaults left = faults_of(result.mesh);
    EXPECT_EQ(result.done, c.done);
    EXPECT_TRUE(left.is_sound()) << report_of(left, "parts");
    EXPECT_NEAR(left.facts.volume.value_or(0), c.volume, 1e-12);
  }
  // A solid in a solid, or a cavity that is inside out: nobody can tell, so it is listed.
  const MeshFaults left = faults_of(repaired(with(cube, small), {}).mesh);
  EXPECT_FALSE(left.is_sound());
  EXPECT_THAT(left.why_not_solid, HasSubstr("inside another one of the same winding"));
}

// Two boxes with a face in common are one; a triangle that is there twice, once turned, stays once.
TEST(MeshRepair, AnInnerWallGoes) {
  const RepairedMesh joined = repaired(with(cube, cube, {1, 0, 0}), {});
  const MeshFaults left = faults_of(joined.mesh);
  std::printf("  %zu triangles, volume %.12g\n", joined.mesh.triangles.size(), left.facts.volume.value_or(0));
  EXPECT_TRUE(left.is_sound()) << report_of(left, "joined");
  EXPECT_EQ(joined.mesh.triangles.size(), 20u);
  EXPECT_NEAR(left.facts.volume.value_or(0), 2, 1e-12);
  TriangleMesh twice = cube;
  twice.triangles.push_back(turned(TriangleMesh{{}, {cube.triangles[3]}}).triangles[0]);
  EXPECT_THAT(repaired(twice, {}).done, testing::ElementsAre("1 duplicate triangles left out"));
}

// A cavity that is flush with a face: its corners on that face say nothing about inside and outside.
TEST(MeshRepair, APocketThatTouchesItsBoxStaysACavity) {
  const TriangleMesh pocket = turned(box_mesh({0.5, 0.5, 0.5}));
  for (const Vec3d by : {Vec3d{-0.25, 0, 0}, {0.25, 0, 0}, {0, -0.25, 0}, {0, 0, 0.25}, {0.25, 0.25, 0.25}}) {
    const RepairedMesh result = repaired(with(cube, pocket, by), {});
    const MeshFaults left = faults_of(result.mesh);
    EXPECT_THAT(result.done, testing::Not(testing::Contains(HasSubstr("turned"))));
    EXPECT_NEAR(left.facts.volume.value_or(0), 0.875, 1e-12);
    EXPECT_FALSE(left.is_sound());
  }
}

// Partly inside: nobody can tell a cavity from a solid that passes through the surface.
TEST(MeshRepair, SaysWhatCannotBeJudged) {
  const TriangleMesh ball_of_one = sphere_mesh(1, 32), block = turned(box_mesh({0.5, 0.5, 0.5}));
  const RepairedMesh result = repaired(with(ball_of_one, block, {0.7, 0.7, 0}), {});
  EXPECT_THAT(result.done, testing::Not(testing::Contains(HasSubstr("turned"))));
  ASSERT_EQ(result.unclear.size(), 1u);
  EXPECT_THAT(result.unclear[0], HasSubstr("cannot be judged"));
  EXPECT_TRUE(repaired(with(ball_of_one, block, {0.2, 0, 0}), {}).unclear.empty());
}

TEST(MeshCoarsen, StaysWithinTheStatedDeviation) {
  const TriangleMesh fine = sphere_mesh(0.1, 96);
  const CoarseMesh coarse = coarsened(fine, 1e-3);
  EXPECT_LT(coarse.mesh.triangles.size() * 5, fine.triangles.size());
  EXPECT_TRUE(faults_of(coarse.mesh).is_sound());
  // Measured again, by other points.
  const double moved = distance_between(fine, coarse.mesh);
  const double before = *facts_of(fine).volume, after = *facts_of(coarse.mesh).volume;
  std::printf("  %zu of %zu triangles, moved by %.2g m (limit 1e-3), volume %+.1e\n",
              coarse.mesh.triangles.size(), fine.triangles.size(), moved, after / before - 1);
  EXPECT_LE(moved, 1.05e-3);
  EXPECT_NEAR(after, before, 1e-3 * before);
}

}  // namespace mesh_tools_test
}  // namespace tandem::launch
