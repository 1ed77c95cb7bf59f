#include "particles/io/fill.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "particles/geometry/periods.hpp"
#include "tests/unit/dem_geometry/walls.hpp"

namespace tandem::particles::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

scene::ParticleGroup group(const std::string& name, decltype(scene::ParticleGroup::fill) fill,
                           double radius_min = 0.01, double radius_max = 0.01) {
  scene::ParticleGroup g;
  g.name = name;
  g.radius_min = radius_min;
  g.radius_max = radius_max;
  g.velocity = {0, 0, -1};
  g.fill = std::move(fill);
  return g;
}

scene::LatticeFill lattice(const std::string& kind, Vec3d max, double jitter) {
  scene::LatticeFill f;
  f.min = {0, 0, 0};
  f.max = max;
  f.lattice = kind;
  f.spacing = 0.025;
  f.jitter = jitter;
  return f;
}

scene::Scene scene_of(const std::vector<scene::ParticleGroup>& groups) {
  scene::Scene s = empty_scene();
  s.dem->particles = groups;
  return s;
}

std::string message(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::scene);
    return e.what();
  }
  return "no error";
}

TEST(Fill, LatticesKeepSpheresApartAndInTheirBox) {
  for (const std::string kind : {"cubic", "hexagonal"}) {
    for (const double jitter : {0.0, 1.0}) {
      const Vec3d max{0.27, 0.25, 0.23};
      const scene::Scene s = scene_of({group("g", lattice(kind, max, jitter), 0.008, 0.01)});
      const Fill fill = make_fill(s, {});
      ASSERT_GT(fill.position.size(), 500u);
      double closest = 1;
      for (std::size_t i = 0; i < fill.position.size(); ++i) {
        ASSERT_TRUE(fill.radius[i] >= 0.008 && fill.radius[i] <= 0.01);
        for (int a = 0; a < 3; ++a) {
          ASSERT_GE(fill.position[i][a], 0.01 - 1e-12);
          ASSERT_LE(fill.position[i][a], max[a] - 0.01 + 1e-12);
        }
        for (std::size_t j = 0; j < i; ++j)
          closest = std::min(closest, norm(fill.position[i] - fill.position[j]));
      }
      // Touching spheres of the largest radius with full jitter; without jitter the spacing of the lattice.
      EXPECT_GE(closest, (jitter > 0 ? 0.02 : 0.025) - 1e-12) << kind;
      if (jitter == 0) {
        EXPECT_NEAR(closest, 0.025, 1e-12);
      }
      if (jitter > 0) {
        EXPECT_LT(closest, 0.0245);
      }
      // A box of walls round the fill is not in contact.
      const Vec3d middle = 0.5 * max;
      const scene::Wall box = wall("box", scene::BoxShape{max, {}}, ground, {middle, {}});
      EXPECT_NO_THROW(check_start(fill, surface_of({box}, 0.011), [&] {
        scene::Scene with = s;
        with.dem->walls = {box};
        return with;
      }()));
    }
  }
}

TEST(Fill, IsTheSameBitsForTheSameSeed) {
  scene::LatticeFill f = lattice("hexagonal", {0.2, 0.2, 0.2}, 0.8);
  const Fill a = make_fill(scene_of({group("g", f, 0.008, 0.01)}), {});
  const Fill b = make_fill(scene_of({group("g", f, 0.008, 0.01)}), {});
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.radius, b.radius);
  f.seed = 2;
  EXPECT_NE(make_fill(scene_of({group("g", f, 0.008, 0.01)}), {}).position, a.position);
  // First outputs of splitmix64 for the seed 1: 0x910a2dec89025cc1, 0xbeeb8da1658eec67.
  f = lattice("cubic", {0.2, 0.2, 0.2}, 1);
  f.seed = 1;
  f.min = {-1, -1, -1};
  const Fill c = make_fill(scene_of({group("g", f)}), {});
  const double half_gap = 0.0025;
  const double u = static_cast<double>(0x910a2dec89025cc1u >> 11) * 0x1p-53;
  EXPECT_DOUBLE_EQ(c.position[0].x, -0.99 + half_gap * u);
}

TEST(Fill, RadiiAreUniform) {
  const Fill fill = make_fill(scene_of({group("g", lattice("cubic", {0.8, 0.8, 0.8}, 0), 0.006, 0.01)}), {});
  double sum = 0, square = 0;
  for (const double r : fill.radius) {
    sum += r;
    square += r * r;
  }
  const double n = static_cast<double>(fill.radius.size()), mean = sum / n;
  EXPECT_NEAR(mean, 0.008, 4 * 0.004 / std::sqrt(12 * n));
  EXPECT_NEAR(square / n - mean * mean, 0.004 * 0.004 / 12, 1e-7);
}

TEST(Fill, StopsAtItsCountFromTheBottomOrTellsHowManyFit) {
  scene::LatticeFill f = lattice("cubic", {0.1, 0.1, 1}, 0);
  f.count = 20;
  const Fill fill = make_fill(scene_of({group("g", f)}), {});
  ASSERT_EQ(fill.position.size(), 20u);
  EXPECT_NEAR(fill.position.back().z, 0.035, 1e-12);
  EXPECT_EQ(fill.velocity.back(), (Vec3d{0, 0, -1}));
  f.count = 1000;
  EXPECT_THAT(
      message([&] { make_fill(scene_of({group("sand", f)}), {}); }),
      AllOf(HasSubstr("dem.particles[0] 'sand'"), HasSubstr("1000 spheres do not fit: the lattice has 640")));
  EXPECT_THAT(message([&] {
                make_fill(scene_of({group("sand", lattice("cubic", {0.1, 0.1, 0.01}, 0))}), {});
              }),
              HasSubstr("holds no sphere"));
}

TEST(Fill, TakesRadiiAndVelocitiesFromTheFileOrTheGroup) {
  const NamedParticles full{"a", {{{0, 0, 0}, {1, 0, 0}}, {0.1, 0.2}, {{1, 2, 3}, {4, 5, 6}}, {}}};
  const NamedParticles bare{"b", {{{0, 5, 0}}, {}, {}, {}}};
  auto a = group("a", scene::FileFill{"a.csv"}, 0, 0), b = group("b", scene::FileFill{"b.csv"}, 0.3, 0.3);
  b.material = MaterialId{1};
  const Fill fill = make_fill(scene_of({a, b}), {full, bare});
  EXPECT_EQ(fill.radius, (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(fill.velocity, (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}, {0, 0, -1}}));
  EXPECT_EQ(fill.material, (std::vector<std::uint32_t>{0, 0, 1}));
  EXPECT_EQ(fill.group, (std::vector<std::uint32_t>{0, 0, 1}));
  EXPECT_THAT(message([&] { make_fill(scene_of({a, b}), {full}); }), HasSubstr("no particle file came"));
  b.radius_min = b.radius_max = 0;
  EXPECT_THAT(message([&] { make_fill(scene_of({b}), {bare}); }),
              HasSubstr("neither the group nor its file"));
}

// ---- check_start

// Two spheres that overlap by 3 %, from a file without and with spins.
TEST(Fill, OverlapsOfABedUnderItsLoadAreAccepted) {
  const std::vector<Vec3d> positions{{0, 0, 0}, {0, 0, 0.197}}, zero(2);
  scene::Scene scene = scene_of({group("a", scene::FileFill{"a.csv"}, 0, 0)});
  const auto start = [&](const std::vector<Vec3d>& spins) {
    const Fill fill = make_fill(scene, {{"a", {positions, {0.1, 0.1}, zero, spins}}});
    return message([&] { check_start(fill, make_surface(scene, {}, 0.1), scene); });
  };
  EXPECT_THAT(start({}), AllOf(HasSubstr("3 % of the radius of the smaller"), HasSubstr("in the file")));
  EXPECT_THAT(start(zero), HasSubstr("no error"));
  scene.dem->overlap_limit = 0.02;
  EXPECT_THAT(start(zero), AllOf(HasSubstr("3 % of the radius of the smaller"),
                                 HasSubstr("use a stiffer material, or a larger dem.overlap_limit")));
}

Fill spheres(const std::vector<std::pair<Vec3d, double>>& list) {
  Fill fill;
  for (const auto& [p, r] : list) {
    fill.position.push_back(p);
    fill.velocity.push_back({});
    fill.radius.push_back(r);
    fill.material.push_back(0);
    fill.group.push_back(0);
  }
  return fill;
}

std::string start(const Fill& fill, const std::vector<scene::Wall>& walls = {}, double reach = 5,
                  unsigned threads = 1) {
  scene::Scene s = scene_of({group("sand", scene::FileFill{"sand.csv"})});
  s.dem->walls = walls;
  s.mbd.emplace();
  scene::Body body;
  body.pose = {{10, 0, 0}, exp({0, 0, 1})};
  s.mbd->bodies.push_back(body);
  return message([&] { check_start(fill, make_surface(s, {}, reach), s, threads); });
}

TEST(CheckStart, NamesTheWorstPairOfSpheres) {
  EXPECT_EQ(start(spheres({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{0, 1.995, 0}, 1}})),
            "no error");  // as in a settled bed
  EXPECT_EQ(start(spheres({{{0, 0, 0}, 1}, {{1.9, 0, 0}, 1}, {{5, 5, 5}, 0.5}, {{5, 5, 5.75}, 0.5}})),
            "dem.particles[0] 'sand': sphere 2 at (5, 5, 5) m overlaps sphere 3 at (5, 5, 5.75) m of 'sand' "
            "by 0.25 m, "
            "50 % of the radius of the smaller (move the spheres apart in the file)");
}

TEST(CheckStart, FindsTheSamePairAsBruteForceForAnyMixOfSizes) {
  Random random(6);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<std::pair<Vec3d, double>> list;
    for (int i = 0; i < 60; ++i) {
      const double r = i % 20 == 0 ? random(0.5, 2) : random(0.01, 0.1);
      list.push_back({random.vector(-8, 8), r});
    }
    double worst = start_overlap_limit;
    for (std::size_t i = 0; i < list.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double overlap = list[i].second + list[j].second - norm(list[i].first - list[j].first);
        worst = std::max(worst, overlap / std::min(list[i].second, list[j].second));
      }
    }
    char text[60];
    std::snprintf(text, sizeof text, ", %.3g %% of the radius", 100 * worst);
    EXPECT_THAT(start(spheres(list)), HasSubstr(worst > start_overlap_limit ? text : "no error"));
  }
}

// Of equal overlaps the first one, also at walls.
TEST(CheckStart, NamesTheSamePairForAnyNumberOfThreads) {
  std::vector<std::pair<Vec3d, double>> pairs, sunk;
  for (int k = 0; k < 7; ++k) {
    pairs.push_back({{0, 0, 4.0 * k}, 1});
    pairs.push_back({{0, 1.75, 4.0 * k}, 1});
    sunk.push_back({{4.0 * k, 0, 0.5}, 1});
  }
  const scene::Wall floor = wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}});
  for (const unsigned threads : {1u, 2u, 3u, 5u, 20u}) {
    EXPECT_THAT(start(spheres(pairs), {}, 5, threads),
                HasSubstr("sphere 0 at (0, 0, 0) m overlaps sphere 1 at"));
    EXPECT_THAT(start(spheres(sunk), {floor}, 5, threads),
                HasSubstr("sphere 0 at (0, 0, 0.5) m overlaps wall"));
  }
  pairs[9].first.y = 1.7;
  EXPECT_THAT(start(spheres(pairs), {}, 5, 3), HasSubstr("sphere 8 at (0, 0, 16) m overlaps sphere 9 at"));
}

TEST(CheckStart, NamesTheWallWhereverItsBodyStands) {
  const scene::Wall floor = wall("floor", scene::PlaneShape{{0, 0, -1}, {0, 0, 1}});
  const scene::Wall box = wall("bucket", scene::BoxShape{{4, 4, 4}, {"+z"}}, BodyId{0});
  EXPECT_EQ(start(spheres({{{0, 0, 0}, 1}, {{10, 0, 0}, 0.5}}), {floor, box}), "no error");
  EXPECT_THAT(start(spheres({{{0, 0, -0.5}, 1}}), {floor, box}),
              HasSubstr("overlaps wall 'floor' by 0.5 m, 50 %"));
  const Vec3d side = Vec3d{10, 0, 0} + exp({0, 0, 1}).rotate({1.7, 0.3, 0});
  EXPECT_THAT(start(spheres({{side, 0.5}}), {floor, box}),
              AllOf(HasSubstr("'sand': sphere 0 at"), HasSubstr("overlaps wall 'bucket' by 0.2 m, 40 %")));
}

TEST(CheckStart, RefusesNoSpheresNaNAndSpheresOutsideTheDomain) {
  EXPECT_THAT(start({}), HasSubstr("the fills hold no sphere"));
  EXPECT_THAT(start(spheres({{{0, std::nan(""), 0}, 1}})), HasSubstr("is no number"));
  EXPECT_THAT(start(spheres({{{0, 0, 0}, 0}})), HasSubstr("is no number"));
  EXPECT_THAT(start(spheres({{{0, 0, 101}, 1}})), HasSubstr("outside the domain"));
}

// ---- relax_start

StartRelaxation relax(Fill& fill, const std::vector<scene::Wall>& walls = {}) {
  scene::Scene s = scene_of({group("sand", scene::FileFill{"sand.csv"})});
  s.dem->walls = walls;
  const Surface surface = make_surface(s, {}, 5);
  const StartRelaxation result = relax_start(fill, surface, s);
  check_start(fill, surface, s);
  return result;
}

TEST(RelaxStart, PartsAHeapOnAFloorTheSameWayEachTime) {
  Random random(3);
  std::vector<std::pair<Vec3d, double>> list;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y) list.push_back({{1.9 * x + random(-0.1, 0.1), 1.9 * y, 0.8}, random(0.8, 1)});
  const Fill before = spheres(list);
  Fill once = before, again = before;
  const scene::Wall floor = wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}});
  EXPECT_NE(start(before, {floor}), "no error");
  const StartRelaxation result = relax(once, {floor});
  relax(again, {floor});
  EXPECT_EQ(once.position, again.position);
  std::printf("%zu of 36 moved by at most %.3g m in %d sweeps, worst overlap before %.3g\n", result.moved,
              result.largest_move, result.sweeps, result.worst);
  EXPECT_GT(result.worst, 0.1);
  EXPECT_GT(result.moved, 20u);
  EXPECT_LT(result.largest_move, 0.8) << "no sphere goes further than its radius";
  EXPECT_EQ(once.velocity, before.velocity);
}

TEST(RelaxStart, LeavesASettledStartAsItIs) {
  Fill fill = spheres({{{0, 0, 0}, 1}, {{1.995, 0, 0}, 1}, {{0, 5, 0}, 1}});
  const std::vector<Vec3d> before = fill.position;
  EXPECT_EQ(relax(fill).moved, 0u);
  EXPECT_EQ(fill.position, before);
}

TEST(RelaxStart, TheLighterSphereMovesAndSpheresInOnePlacePart) {
  Fill fill = spheres({{{0, 0, 0}, 2}, {{2.8, 0, 0}, 1}});
  relax(fill);
  EXPECT_NEAR(fill.position[0].x / (2.8 - fill.position[1].x), 1.0 / 8, 1e-9);
  Fill same = spheres({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}});
  EXPECT_EQ(relax(same).worst, 2);
  EXPECT_NEAR(norm(same.position[0] - same.position[1]), 2, 0.011);
}

TEST(RelaxStart, RefusesWhereThereIsNoRoom) {
  std::vector<std::pair<Vec3d, double>> list;
  for (int i = 0; i < 20; ++i) list.push_back({{0.1 * i, 0.03 * i * i, 0}, 1});
  EXPECT_THAT(message([&] {
                Fill fill = spheres(list);
                relax(fill);
              }),
              AllOf(HasSubstr("among overlapping ones, would have to move by more than its radius"),
                    HasSubstr("'sand'"), HasSubstr("fewer or smaller spheres, or a start that was left")));
  EXPECT_THAT(message([&] {
                Fill fill = spheres({{{0, 0, -0.3}, 1}});
                relax(fill, {wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}})});
              }),
              AllOf(HasSubstr("in a wall, would have to move by more than its radius"),
                    HasSubstr("move the group or the wall")));
  EXPECT_THAT(message([&] {
                Fill fill = spheres({{{0, std::nan(""), 0}, 1}});
                relax(fill);
              }),
              HasSubstr("is no number"));
}

// Walls and other spheres may push a sphere out of the domain.
TEST(RelaxStart, SaysFromWhereASphereWasMovedOutOfTheDomain) {
  EXPECT_EQ(message([] {
              Fill fill = spheres({{{100, 0, 0}, 1}, {{98.5, 0, 0}, 1}});
              relax(fill);
            }),
            "dem.particles[0] 'sand': sphere 0, which starts at (100, 0, 0) m among overlapping ones or in a "
            "wall, was moved out of the domain by start_overlap \"relax\", to (100.25, 0, 0) m (enlarge "
            "dem.domain, or move what overlaps there apart)");
}

// ---- periodic domains

scene::Scene periodic_scene(std::array<bool, 3> axes) {
  scene::Scene s = scene_of({group("sand", scene::FileFill{"sand.csv"})});
  s.dem->domain = {{0, 0, 0}, {10, 10, 10}};
  s.dem->periodic = axes;
  return s;
}

TEST(PeriodicStart, FindsTheWorstPairAcrossFacesAsBruteForceDoes) {
  Random random(8);
  int across = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const scene::Scene s = periodic_scene({true, trial % 2 == 0, trial % 3 == 0});
    const Periods periods = periods_of(*s.dem);
    std::vector<std::pair<Vec3d, double>> list;
    for (int i = 0; i < 60; ++i)
      list.push_back({random.vector(0, 10), i % 20 == 0 ? random(0.5, 1.5) : random(0.05, 0.2)});
    double worst = start_overlap_limit, inside = worst;
    for (std::size_t i = 0; i < list.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3d apart = list[i].first - list[j].first;
        const double reach = list[i].second + list[j].second,
                     smaller = std::min(list[i].second, list[j].second);
        worst = std::max(worst, (reach - norm(periods.shortest(apart))) / smaller);
        inside = std::max(inside, (reach - norm(apart)) / smaller);
      }
    across += worst > inside ? 1 : 0;
    char text[60];
    std::snprintf(text, sizeof text, ", %.3g %% of the radius", 100 * worst);
    EXPECT_THAT(message([&] { check_start(spheres(list), make_surface(s, {}, 2), s); }),
                HasSubstr(worst > start_overlap_limit ? text : "no error"));
  }
  EXPECT_GT(across, 5);
}

TEST(PeriodicStart, IsRelaxedAcrossFaces) {
  const scene::Scene s = periodic_scene({true, false, true});
  const Surface surface = make_surface(s, {}, 2);
  Fill fill = spheres({{{0.1, 5, 9.9}, 1}, {{9, 5, 0.2}, 1}, {{0.2, 0.2, 5}, 0.5}, {{0.2, 9.9, 5}, 0.5}});
  EXPECT_NE(message([&] { check_start(fill, surface, s); }), "no error");
  EXPECT_EQ(relax_start(fill, surface, s).moved, 2u) << "the domain does not repeat along y";
  EXPECT_EQ(message([&] { check_start(fill, surface, s); }), "no error");
  EXPECT_NEAR(norm(periods_of(*s.dem).shortest(fill.position[0] - fill.position[1])), 2, 0.011);
  for (const Vec3d& x : fill.position) EXPECT_EQ(periods_of(*s.dem).wrapped(x), x);
}

TEST(PeriodicStart, WallsThatEndAtAFaceAreWarnedOf) {
  scene::Scene s = periodic_scene({true, false, false});
  const auto warnings = [&](Vec3d box) {
    s.dem->walls = {wall("rail", scene::BoxShape{box, {}}, ground, {{5, 5, 5}, {}}),
                    wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}})};
    return warn_of_walls_at_periodic_faces(make_surface(s, {}, 2), s, 0.5);
  };
  EXPECT_THAT(warnings({10, 1, 1}),
              testing::ElementsAre(HasSubstr("walls of 'ground' end within a radius of a "
                                             "periodic face along x")));
  EXPECT_THAT(warnings({12, 10, 1}), testing::IsEmpty());
  EXPECT_THAT(warnings({4, 10, 10}), testing::IsEmpty());
}

TEST(Periods, WrapIntoTheDomain) {
  Periods p{{-1, 0, 0}, {3, 0, 0}};
  EXPECT_EQ(p.wrapped({2, 7, -8}), (Vec3d{-1, 7, -8}));
  EXPECT_EQ(p.wrapped({-1.5, 0, 0}), (Vec3d{1.5, 0, 0}));
  EXPECT_EQ(p.wrapped({-1 - 1e-300, 0, 0}).x, -1);
  EXPECT_EQ(p.wrapped({31, 0, 0}).x, 1);
  EXPECT_TRUE(std::isnan(p.wrapped({std::nan(""), 0, 0}).x));
  EXPECT_EQ(p.shortest({2, 9, 0}), (Vec3d{-1, 9, 0}));
}

}  // namespace
}  // namespace tandem::particles::test
