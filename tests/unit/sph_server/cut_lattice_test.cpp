// The lattice that a liquid starts from, cut at walls, and its relaxation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sph_server/engine/cut_lattice.hpp"
#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/region_columns.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace cut_lattice_test {

using namespace sph;

constexpr double spacing = 0.1;
const Vec3d unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other, bool reverse = false) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    if (reverse)
      mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    else
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return mesh;
}

// A vessel without lid with its lowest point at the origin, of the given size.
struct Vat {
  LiquidSetup setup;
  TriangleMesh region;
  Pose pose;
  double depth;
  explicit Vat(Vec3d size, double level, const Pose& at = {}) : pose(at), depth(level) {
    const Pose up{{0, 0, 0.5 * size.z}, {}};
    setup.walls = {transformed(box_mesh(size, {"+z"}), up)};
    region = transformed(box_mesh(size), up);
    finish();
  }
  Vat(double radius, double height, int segments, double level, const Pose& at = {})
      : pose(at), depth(level) {
    const Pose up{{0, 0, 0.5 * height}, {}};
    setup.walls = {transformed(cylinder_mesh(radius, height, segments, {"+z"}), up)};
    region = transformed(cylinder_mesh(radius, height, segments), up);
    finish();
  }
  void add_sheet(double x, double half_width, double height) {
    TriangleMesh sheet;
    sheet.vertices = {
        {x, -half_width, 0}, {x, half_width, 0}, {x, half_width, height}, {x, -half_width, height}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    setup.walls[0] = joined(setup.walls[0], sheet);
  }
  void add_solid(const TriangleMesh& solid) {
    setup.walls[0] = joined(setup.walls[0], solid);
    region = joined(region, solid, true);
  }
  void finish() {
    Liquid& l = setup.liquid;
    l.spacing = spacing;
    l.gravity = pose.q_WB.rotate({0, 0, -9.81});
    l.sound_speed = suggested_sound_speed(0, 9.81, depth);
    setup.domain = {pose.p_WB - Vec3d{3, 3, 3}, pose.p_WB + Vec3d{3, 3, 3}};
  }
  std::vector<particles::BodyPose> poses() const { return {{pose.p_WB, pose.q_WB.matrix(), {}, {}}}; }
  Filling filling() const { return {transformed(region, pose), {depth, {}}, pose.q_WB.matrix()}; }
  std::vector<Vec3d> lattice(bool whole = false) const {
    const Filling f = filling();
    const FilledPart part = filled_part(setup.liquid, f.region, f.amount);
    Walls walls(setup.walls, setup.liquid.support());
    walls.set_pose(0, poses()[0]);
    const LatticeAxes axes = lattice_axes(part.up, f.axes);
    return whole ? whole_lattice(part.region, walls, setup.liquid, {axes, part.level, false}, part.particles,
                                 setup.threads)
                 : cut_lattice(part.region, walls, setup.liquid, {axes, part.surface, true}, part.particles,
                               setup.threads);
  }
  FilledPlaces places() const { return fill_places(setup, poses(), filling()); }
  // Of the volume below the level, in particles.
  double wanted() const { return volume_below(region, {0, 0, 1}, depth) / (spacing * spacing * spacing); }
};

void expect_figure(const char* what, double expected, double measured, double tolerance) {
  std::printf("%s: expected %.6g, measured %.6g, tolerance %.3g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

TEST(RegionColumns, CountTheSurfacesThatALinePasses) {
  // A box with a cavity, and a second box that has a part in common with the first.
  const TriangleMesh mesh = joined(joined(box_mesh({2, 2, 2}), box_mesh({1, 1, 1}), true),
                                   transformed(box_mesh({1, 1, 1}), Pose{{1, 1, 1}, {}}));
  const RegionColumns columns(mesh, unit);
  ColumnCrossings line;
  columns.find(0.2, 0.1, line);
  for (const auto& [z, inside] :
       {std::pair{-1.1, false}, {-0.7, true}, {0.0, false}, {0.7, true}, {1.2, false}})
    EXPECT_EQ(line.inside(z), inside) << z;
  columns.find(0.7, 0.8, line);
  for (const auto& [z, inside] :
       {std::pair{-1.1, false}, {0.0, true}, {0.7, true}, {1.2, true}, {1.6, false}})
    EXPECT_EQ(line.inside(z), inside) << z;
  // Through edges and corners of the triangles.
  columns.find(0.75, 0.75, line);
  EXPECT_TRUE(line.inside(-0.7));
  EXPECT_TRUE(line.inside(0.0));
  columns.find(2, 0, line);
  EXPECT_FALSE(line.inside(0));
}

TEST(CutLattice, FitsABoxOfWholeSpacings) {
  const std::vector<Vec3d> lattice = Vat({1, 0.5, 1}, 0.4).lattice(true);
  EXPECT_EQ(lattice.size(), 10u * 5 * 4);
  for (const Vec3d& x : lattice) EXPECT_NEAR(std::remainder(x.x - 0.05, spacing), 0, 1e-12);
}

TEST(CutLattice, HasTheMassOfTheLiquidNearEachWall) {
  // A box that no lattice fits, with a thin sheet that cuts its cells at a fifth of their width.
  Vat vat({1.44, 0.63, 1}, 0.567);
  const double sheet = 0.12;
  vat.add_sheet(sheet, 0.315, 1);
  EXPECT_TRUE(vat.lattice(true).empty());
  const std::vector<Vec3d> lattice = vat.lattice();
  expect_figure("particles", vat.wanted(), static_cast<double>(lattice.size()), 0.5);
  const auto share = [&](auto in) {
    return static_cast<double>(std::ranges::count_if(lattice, in)) / static_cast<double>(lattice.size());
  };
  expect_figure("share on one side of the sheet", (0.72 + sheet) / 1.44,
                share([&](Vec3d x) { return x.x < sheet; }), 0.005);
  expect_figure("share within two spacings of the sheet, one side", 0.2 / 1.44,
                share([&](Vec3d x) { return x.x < sheet && x.x > sheet - 0.2; }), 0.016);
  expect_figure("share within two spacings of a wall", 0.2 / 1.44,
                share([&](Vec3d x) { return x.x < -0.72 + 0.2; }), 0.016);
  expect_figure("share in one half", 0.5, share([&](Vec3d x) { return x.y < 0; }), 0.015);
}

TEST(CutLattice, LeavesOutSolidsThinnerThanASpacing) {
  Vat vat({1.2, 0.8, 1}, 0.6);
  const TriangleMesh plate = transformed(box_mesh({0.013, 0.8, 1.2}), Pose{{0.031, 0, 0.6}, {}});
  vat.add_solid(plate);
  const std::vector<Vec3d> lattice = vat.lattice();
  expect_figure("particles", vat.wanted(), static_cast<double>(lattice.size()), 0.5);
  for (const Vec3d& x : lattice) EXPECT_FALSE(std::fabs(x.x - 0.031) < 0.0065) << x.x;
}

TEST(CutLattice, TurnsWithTheVesselAndIsTheSameForAnyNumberOfThreads) {
  // A level of five and a half spacings.
  const Pose turned{{0.4, -0.7, 1.1}, exp(Vec3d{0.3, -0.5, 0.8})};
  Vat vat(0.47, 1, 12, 0.55), moved(0.47, 1, 12, 0.55, turned);
  const std::vector<Vec3d> here = vat.lattice(), there = moved.lattice();
  ASSERT_EQ(here.size(), there.size());
  double apart = 0;
  for (std::size_t i = 0; i < here.size(); ++i)
    apart = std::max(apart, norm(turned.p_WB + turned.q_WB.rotate(here[i]) - there[i]));
  expect_figure("largest distance after the motion [m]", 0, apart, 1e-12);
  vat.setup.threads = 3;
  const std::vector<Vec3d> again = vat.lattice();
  EXPECT_TRUE(again == here);
}

TEST(CutLattice, RefusesWhatTheWallsLeaveNoRoomFor) {
  const Vat vat({1, 1, 1}, 0.55);
  const Filling f = vat.filling();
  const Walls walls(vat.setup.walls, vat.setup.liquid.support());
  EXPECT_EQ(error_of([&] {
              cut_lattice(f.region, walls, vat.setup.liquid, {lattice_axes({0, 0, 1}, f.axes), 0.5}, 700, 1);
            }),
            "scene: fill: 700 particles of the liquid's mass, and its walls leave room for 502 (let closed "
            "walls in the liquid be apart from each other, or take a smaller spacing)");
}

// In a round tank with a shaft; what remains of the forces at the start and what they make of it.
TEST(FilledRegion, IsAtRestInARoundTankWithAShaft) {
  Vat vat(0.6, 1, 16, 0.7);
  vat.add_solid(transformed(cylinder_mesh(0.16, 1.4, 8), Pose{{0.06, 0.02, 0.7}, {}}));
  int steps = 0, all = 0;
  const FilledPlaces places = fill_places(vat.setup, vat.poses(), vat.filling(), [&](int done, int of) {
    EXPECT_EQ(done, ++steps);
    all = of;
  });
  EXPECT_TRUE(places.relaxed);
  EXPECT_EQ(steps, all);
  expect_figure("steps of the relaxation", 80, steps, 0);
  expect_figure("particles", vat.wanted(), static_cast<double>(places.position.size()), 0.5);
  const auto engine = make_liquid_engine(vat.setup, true);
  engine->set_state(at_rest_in(vat.setup, vat.filling(), places.position), vat.poses());
  expect_figure("largest acceleration at the start / gravity", 0,
                engine->figures().largest_acceleration / 9.81, 1.5);
  const double weight = static_cast<double>(places.position.size()) * vat.setup.liquid.mass() * 9.81;
  const Wrench load = engine->loads()[0];
  expect_figure("load / weight at the start", 1, -load.force.z / weight, 0.03);
  double highest = 0;
  for (const Vec3d& x : places.position) highest = std::max(highest, x.z);
  expect_figure("highest particle below the level [spacings]", 0.5, (vat.depth - highest) / spacing, 0.2);
}

TEST(FilledRegion, HasTheSameBitsForAnyNumberOfThreads) {
  Vat vat(0.33, 0.6, 10, 0.4);
  const std::vector<Vec3d> one = vat.places().position;
  vat.setup.threads = 3;
  EXPECT_TRUE(vat.places().position == one);
}

TEST(FilledRegion, EndsWhereTheUserWishes) {
  Vat vat(0.33, 0.6, 10, 0.4);
  EXPECT_EQ(error_of([&] {
              fill_places(vat.setup, vat.poses(), vat.filling(), [](int done, int) {
                if (done == 3) throw Error(ErrorCode::interrupted, "enough");
              });
            }),
            "interrupted: enough");
}

TEST(FilledRegion, RefusesPlacesOfAnotherLiquid) {
  const Vat vat({1, 0.5, 1}, 0.4);
  EXPECT_EQ(error_of([&] {
              at_rest_in(vat.setup, vat.filling(), {{0, 0, 0.1}});
            }),
            "protocol: fill: 1 places for 200 particles (this is a defect of the coordinator)");
}

}  // namespace cut_lattice_test
}  // namespace tandem::test
