// What is between two points, and what the lists make of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "sph_server/backend/cpu/exec_cpu.hpp"
#include "sph_server/kernel/seen_integrals.hpp"
#include "sph_server/neighbours/walls.hpp"
#include "sph_server/step/see_facets.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using namespace sph;

// A sheet in the plane x = 0 with a hole where |y| < 0.1 and z is above 1.
TriangleMesh sheet() {
  TriangleMesh m;
  m.vertices = {{0, -2, 0}, {0, 2, 0}, {0, 2, 1}, {0, -2, 1}, {0, -0.1, 1}, {0, -0.1, 2}, {0, -2, 2}};
  m.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 4, 5}, {3, 5, 6}};
  return m;
}

TEST(Walls, AreBetweenPointsOnBothSides) {
  const Walls walls({sheet()}, 0.5);
  EXPECT_TRUE(walls.between({-0.1, 0, 0.5}, {0.1, 0.2, 0.5}));
  EXPECT_TRUE(walls.between({0.1, 0.2, 0.5}, {-0.1, 0, 0.5}));
  EXPECT_FALSE(walls.between({0.1, 0, 0.5}, {0.3, 0, 0.5}));
  EXPECT_FALSE(walls.between({-0.1, 0, 1.5}, {0.1, 0, 1.5})) << "through the hole";
  // The diagonal between two triangles belongs to both.
  EXPECT_TRUE(walls.between({-0.1, 0, 0.5}, {0.1, 0, 0.5}));
}

// Meshes of one surface in several patches have slots of rounding size between their facets.
TEST(Walls, AreTightWhereFacetsNearlyJoin) {
  const double reach = 0.03, slot = 5e-7;
  TriangleMesh m;
  m.vertices = {{0, -1, 0}, {0, 1, 0}, {0, 1, 1}, {0, -1, -slot}, {0, 0.3, -slot}, {0, 0, -1}};
  m.triangles = {{0, 1, 2}, {3, 4, 5}};
  const Walls walls({m}, reach);
  EXPECT_TRUE(walls.between({-0.01, 0.2, -0.4 * slot}, {0.01, 0.2, -0.4 * slot}));
  EXPECT_TRUE(walls.between({-0.01, 0.5, -0.4 * slot}, {0.01, 0.5, -0.4 * slot})) << "beside a free edge";
  EXPECT_FALSE(walls.between({-0.01, 0.5, -1.1e-4 * reach}, {0.01, 0.5, -1.1e-4 * reach}));
}

TEST(Walls, AreFoundWhereTheirBodyIs) {
  Walls walls({sheet()}, 0.5);
  NearWalls near;
  walls.find({0.2, 0.5, 0.5}, 0.3, near);
  EXPECT_EQ(near.count, 2);
  walls.set_pose(0, {{5, 0, 0}, Mat3d::identity(), {}, {}});
  walls.find({0.2, 0.5, 0.5}, 0.3, near);
  EXPECT_EQ(near.count, 0);
  EXPECT_TRUE(walls.between({4.9, 0, 0.5}, {5.1, 0, 0.5}));
  const particles::BodyPose then{{}, Mat3d::identity(), {}, {}};
  EXPECT_TRUE(walls.view().passed(0, &then, {0.1, 0, 0.5}, {4.9, 0, 0.5}) ||
              walls.view().passed(1, &then, {0.1, 0, 0.5}, {4.9, 0, 0.5}))
      << "the wall moved across the point";
}

TEST(Walls, WithoutAreaAreRefused) {
  TriangleMesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  m.triangles = {{0, 1, 2}};
  EXPECT_EQ(error_of([&] { Walls({m}, 0.1); }),
            "scene: walls of body 0: triangle 0 has no area (remove it from the mesh)");
}

TEST(NeighbourList, EndsAtASheet) {
  const Walls walls({sheet()}, 0.5);
  const scene::Box domain{{-1, -1, 0}, {1, 1, 2}};
  const particles::CellGrid grid = particles::make_cell_grid(domain, {}, 0.5, 1e6);
  const std::vector<Vec3d> x{
      {-0.1, 0.5, 0.5}, {0.1, 0.5, 0.5}, {0.3, 0.5, 0.6}, {-0.05, 0, 1.5}, {0.05, 0, 1.5}};
  CpuExec exec(2);
  CpuExec::Buffer<std::uint32_t> key, scratch, cell_start, in_cell;
  for (auto* array : {&key, &scratch, &in_cell}) array->resize(x.size());
  cell_start.resize(grid.total + 2);
  const auto n = static_cast<std::uint32_t>(x.size());
  exec.sort_into_cells(n, grid.total, CellOfParticle{grid, x.data()}, key.data(), scratch.data(), cell_start,
                       in_cell);
  List<CpuExec, std::uint32_t> facets;
  const std::vector<float> skin(n, 0);
  const Reaches reaches{0.5, skin.data(), skin.data(), 0};
  exec.build_list(n, FindFacets{walls.view(), x.data(), reaches}, facets);
  std::vector<std::uint32_t> particle(facets.total);
  std::vector<float> distance(facets.total), clearance(n);
  exec.for_each(n, NameParticles{facets.view(), particle.data()});
  exec.for_each(facets.total, MeasureFacets{walls.view(), facets.view(), particle.data(), x.data(), reaches,
                                            distance.data()});
  exec.for_each(n, FindClearance{facets.view(), distance.data(), reaches, walls.margin(), clearance.data()});
  EXPECT_NEAR(clearance[0], 0.1, 2e-5);
  EXPECT_NEAR(clearance[3], std::hypot(0.05, 0.1), 2e-5) << "from the edges of the hole";
  EXPECT_LT(clearance[3], std::hypot(0.05, 0.1));
  List<CpuExec, Neighbour> list;
  std::vector<Position<double>> position(n);
  exec.for_each(n, PlaceInCells<double>{{}, {}, skin.data(), x.data(), in_cell.data(), position.data()});
  exec.build_list(n,
                  FindNeighbours<double>{grid,
                                         grid.edge(1),
                                         1,
                                         {},
                                         {},
                                         {},
                                         cell_start.data(),
                                         in_cell.data(),
                                         position.data(),
                                         x.data(),
                                         reaches},
                  list);
  const std::vector<std::uint32_t> all{0, 1, 2, 3, 4};
  exec.keep_entries(
      n, all.data(),
      SeesNeighbour{{}, x.data(), walls.view(), facets.view(), distance.data(), clearance.data()}, list);
  const auto neighbours_of = [view = list.view()](std::uint32_t i) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t k = view.start[i]; k < view.end[i]; ++k) found.push_back(view.entry[k].index());
    return found;
  };
  EXPECT_THAT(neighbours_of(0), testing::IsEmpty());
  EXPECT_THAT(neighbours_of(1), testing::ElementsAre(2u));
  EXPECT_THAT(neighbours_of(2), testing::ElementsAre(1u));
  EXPECT_THAT(neighbours_of(3), testing::ElementsAre(4u));
  EXPECT_THAT(neighbours_of(4), testing::ElementsAre(3u));
}

// Lists of random particles with skins of their own in domains of some cells, periodic along some axes,
// against all pairs.
template <class Real>
void expect_lists_of_all_pairs(int span, Vec3d size, Vec3<bool> periodic, double largest_cell = 0) {
  constexpr double reach = 0.3, support = 0.22, widest = 0.04;
  scene::Box domain{{-0.2, 0.1, 3}, Vec3d{-0.2, 0.1, 3} + size};
  particles::Periods periods;
  periods.min = domain.min;
  for (int a = 0; a < 3; ++a) periods.length[a] = periodic[a] ? size[a] : 0;
  const particles::CellGrid grid =
      particles::make_cell_grid(domain, periods, reach / span, largest_cell > 0 ? 30 : 1e6);
  const auto unit = particles::LengthUnit<Real>::for_lengths(4 * reach);
  Apart<Real> apart{unit, {}};
  for (int a = 0; a < 3; ++a) apart.period[a] = unit.count(periods.length[a]);
  const auto centres = particles::CentreUnit<Real>::for_range(unit, 10, 4);
  std::mt19937_64 random(11);
  std::vector<Vec3d> x(500);
  for (Vec3d& at : x)
    for (int a = 0; a < 3; ++a)
      at[a] = std::uniform_real_distribution<double>(domain.min[a], domain.max[a])(random);
  CpuExec exec(2);
  CpuExec::Buffer<std::uint32_t> key, scratch, cell_start, in_cell;
  for (auto* array : {&key, &scratch, &in_cell}) array->resize(x.size());
  cell_start.resize(grid.total + 2);
  const auto n = static_cast<std::uint32_t>(x.size());
  exec.sort_into_cells(n, grid.total, CellOfParticle{grid, x.data()}, key.data(), scratch.data(), cell_start,
                       in_cell);
  std::vector<Position<Real>> position(n);
  std::vector<float> skin(n), near_skin(n), largest(grid.total);
  for (float& s : skin) s = static_cast<float>(std::uniform_real_distribution<double>(0, widest)(random));
  exec.for_each(grid.total, LargestInCell{cell_start.data(), in_cell.data(), skin.data(), largest.data()});
  exec.for_each(n, FindNearSkin{{grid, x.data(), largest.data()}, span, near_skin.data()});
  const Reaches reaches{support, skin.data(), near_skin.data(), 0};
  exec.for_each(n, PlaceInCells<Real>{centres, unit, skin.data(), x.data(), in_cell.data(), position.data()});
  List<CpuExec, Neighbour> list;
  exec.build_list(n,
                  FindNeighbours<Real>{grid, grid.edge(1), span, apart, centres, periods, cell_start.data(),
                                       in_cell.data(), position.data(), x.data(), reaches},
                  list);
  for (std::uint32_t i = 0; i < n; ++i) {
    std::multiset<std::uint32_t> found, expected;
    for (std::uint32_t k = list.start.data()[i]; k < list.start.data()[i + 1]; ++k) {
      const Neighbour neighbour = list.entry.data()[k];
      found.insert(neighbour.index());
      Vec3d d = x[i] - x[neighbour.index()];
      for (int a = 0; a < 3; ++a) {
        if (neighbour.image() & particles::image_above(a)) d[a] -= periods.length[a];
        if (neighbour.image() & particles::image_below(a)) d[a] += periods.length[a];
      }
      EXPECT_LT(norm(d), support + skin[i] + skin[neighbour.index()])
          << "the image of " << neighbour.index() << " that " << i << " lists";
    }
    for (std::uint32_t j = 0; j < n; ++j)
      if (j != i && norm(periods.shortest(x[i] - x[j])) < support + skin[i] + skin[j]) expected.insert(j);
    EXPECT_EQ(found, expected) << "of particle " << i;
  }
}

TEST(NeighbourList, IsThatOfAllPairs) {
  for (const int span : {1, 2})
    for (const Vec3d size : {Vec3d{0.9, 1, 1.4}, Vec3d{1.24, 0.95, 0.92}, Vec3d{1.5, 1.1, 0.97}})
      for (int axes = 0; axes < 8; ++axes) {
        const Vec3<bool> periodic{(axes & 1) != 0, (axes & 2) != 0, (axes & 4) != 0};
        expect_lists_of_all_pairs<float>(span, size, periodic);
        expect_lists_of_all_pairs<double>(span, size, periodic);
      }
  // Cells that are larger than the range of positions.
  expect_lists_of_all_pairs<float>(1, {30, 1, 1}, {false, false, false}, 8);
}

// Of a lid that covers a round vessel, points inside see a polygon of as many corners as the vessel has.
TEST(Walls, HideWhatOfALidIsOutsideARoundVessel) {
  constexpr double radius = 0.35, level = 0.6, support = 0.3;
  const WallKernel kernel = WallKernel::of(support, support / 3);
  TriangleMesh lid;
  lid.vertices = {{-0.95, -0.95, level}, {0.95, -0.95, level}, {0.95, 0.95, level}, {-0.95, 0.95, level}};
  lid.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const int segments : {8, 20, 24}) {
    const TriangleMesh vessel =
        transformed(cylinder_mesh(radius, 1.2, segments, {"+z"}), Pose{{0, 0, 0.6}, {}});
    const Walls walls({vessel, lid}, support);
    std::vector<Vec3d> rim;
    for (int k = 0; k < segments; ++k) {
      const double angle = 2 * std::numbers::pi * k / segments;
      rim.push_back({radius * std::cos(angle), radius * std::sin(angle), level});
    }
    for (const Vec3d x :
         {Vec3d{0.05, 0.02, 0.55}, Vec3d{-0.18, 0.1, 0.5}, Vec3d{0.2, 0, 0.577}, Vec3d{0.3, 0.02, 0.57}}) {
      NearWalls near;
      walls.find(x, support, near);
      bool complete = true;
      FacetIntegrals seen;
      for (int k = 0; k < near.count; ++k)
        if (near.facet[k].body == 1) seen += seen_integrals(x, near, k, kernel, complete);
      const FacetIntegrals expected = facet_integrals(x, rim.data(), segments, {0, 0, 1}, kernel);
      EXPECT_TRUE(complete);
      EXPECT_NEAR(seen.surface, expected.surface, 1e-5 * expected.surface);
      EXPECT_NEAR(seen.shadow, expected.shadow, 1e-5 * expected.shadow);
    }
  }
}

// A particle stays within its skin for a time: the root of moved + v t + a t^2 / 2 = skin.
TEST(Skin, HoldsForTheTimeInWhichItMayBeLeft) {
  const double time = time_within(0.3, 0.1, 2, 5);
  EXPECT_NEAR(0.1 + 2 * time + 2.5 * time * time, 0.3, 1e-15);
  EXPECT_EQ(time_within(0.3, 0.3, 2, 5), 0);
  EXPECT_GT(time_within(0.3, 0, 0, 0), 1e300) << "at rest";
  EXPECT_TRUE(std::isnan(time_within(0.3, 0, std::nan(""), 0)));
}

TEST(Skin, FollowsTheSpeedBetweenTwoBounds) {
  Liquid l;
  l.spacing = 0.1;
  l.sound_speed = 20;
  const SkinRule rule = SkinRule::of(l, 1e300);
  EXPECT_FLOAT_EQ(rule.at_speed(0), 0.005F);
  EXPECT_FLOAT_EQ(rule.at_speed(0.5), static_cast<float>(0.005 + 0.5 * 8 * 0.3 * l.h() / 20));
  EXPECT_FLOAT_EQ(rule.at_speed(2), 0.03F);
}

// Three times the reach fit into a period for wide skins, and twice the reach always.
TEST(Skin, FitsIntoThePeriod) {
  Liquid l;
  l.spacing = 0.1;
  l.sound_speed = 20;
  const double R = l.support();
  EXPECT_DOUBLE_EQ(SkinRule::of(l, 1.08).widest, 0.03);
  EXPECT_NEAR(3 * (R + 2 * SkinRule::of(l, 1.05).widest), 1.05, 1e-15);
  EXPECT_DOUBLE_EQ(SkinRule::of(l, 0.7).widest, 0.015);
  EXPECT_NEAR(2 * (R + 2 * SkinRule::of(l, 0.64).widest), 0.64, 1e-15);
  EXPECT_EQ(error_of([&] { SkinRule::of(l, 0.61); }),
            "scene: domain: the domain is 0.61 m long along a periodic axis (give it 0.62 m or more)");
}

// Lists of neighbours hold until walls have moved by the skin: a shaft that spins moves by its radius, not by
// its length.
TEST(Walls, HaveMovedAsFarAsTheirFarthestPoint) {
  const double length = 2, edge = 0.1, angle = 0.01;
  Walls walls({box_mesh({length, edge, edge})}, 0.05);
  const particles::BodyPose start{{3, -2, 1}, Mat3d::identity(), {}, {}};
  const auto turned = [&](Vec3d axis) {
    const Vec3d part = std::sin(angle / 2) * axis;
    walls.set_pose(0, {start.p, Quat{std::cos(angle / 2), part.x, part.y, part.z}.matrix(), {}, {}});
    return walls.moved_from({start});
  };
  const double chord = 2 * std::sin(angle / 2);
  EXPECT_NEAR(turned({1, 0, 0}), chord * std::hypot(edge / 2, edge / 2), 1e-12);
  EXPECT_NEAR(turned({0, 0, 1}), chord * std::hypot(length / 2, edge / 2), 1e-12);
  walls.set_pose(0, {start.p + Vec3d{0.3, 0.4, 0}, Mat3d::identity(), {}, {}});
  EXPECT_NEAR(walls.moved_from({start}), 0.5, 1e-12);
  walls.set_pose(0, {start.p, Mat3d::identity(), {1, 2, 0}, {0, 0, 3}});
  EXPECT_NEAR(walls.largest_speed({1, 2, 0}), 3 * std::hypot(length / 2, edge / 2), 1e-12);
}

}  // namespace
}  // namespace tandem::test
