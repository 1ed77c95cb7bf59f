// What points see of facets: which hide each other, which face away, and how many there may be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "common/geometry/mass_properties.hpp"
#include "sph_server/kernel/seen_integrals.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::test {
namespace {

using namespace sph;

constexpr double R = 0.3;
const WallKernel kernel = WallKernel::of(R, R / 3);

// What a particle takes from all facets, without dimension.
struct Sums {
  Vec3d gradient;  // sum of S n + r, times R
  double shadow = 0;
  Mat3d moment;

  void add(const FacetIntegrals& f, const NearFacet& facet) {
    const Vec3d n = facet.height < 0 ? -facet.normal : facet.normal;
    gradient += R * (f.surface * n + f.rim);
    shadow += f.shadow;
    for (int a = 0; a < 3; ++a) {
      moment.row[a] += n[a] * f.moment + f.sides.row[a];
      moment.row[a][a] -= f.shadow;
    }
  }
};
double difference(const Sums& a, const Sums& b) {
  double most = std::max(norm(a.gradient - b.gradient), std::fabs(a.shadow - b.shadow));
  for (int k = 0; k < 3; ++k) most = std::max(most, norm(a.moment.row[k] - b.moment.row[k]));
  return most;
}

Sums seen(Vec3d x, const NearWalls& near) {
  Sums sums;
  bool complete = true;
  for (int k = 0; k < near.count; ++k)
    sums.add(seen_integrals(x, near, k, kernel, complete), near.facet[static_cast<std::size_t>(k)]);
  EXPECT_TRUE(complete);
  return sums;
}

// Each facet cut by the shadows of all others.
Sums cut_by_all(Vec3d x, const NearWalls& near) {
  Sums sums;
  for (int k = 0; k < near.count; ++k) {
    const NearFacet& f = near.facet[static_cast<std::size_t>(k)];
    Polygon whole;
    whole.count = 3;
    whole.corner[0] = f.a;
    whole.corner[1] = f.b;
    whole.corner[2] = f.c;
    const auto shadow = [&](int n) {
      const NearFacet& g = near.facet[static_cast<std::size_t>(n)];
      return n == k ? Shadow{} : Shadow::of(x, g.a, g.b, g.c, g.normal, 1e-6 * R);
    };
    VisibleParts parts(whole, f.normal, x, R, near.count, shadow);
    for (Polygon p; parts.find_next(p);)
      sums.add(facet_integrals(x, p.corner.data(), p.count, f.normal, f.height, kernel), f);
    EXPECT_TRUE(parts.complete());
  }
  return sums;
}

class Random {
 public:
  double operator()() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  Vec3d in_box(double half) {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return half * Vec3d{2 * x - 1, 2 * y - 1, 2 * z - 1};
  }

 private:
  std::mt19937_64 bits_{3};
};

// A sheet in waves that are as high as wide.
TriangleMesh waves() {
  TriangleMesh m;
  constexpr std::uint32_t n = 16;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t k = 0; k <= n; ++k) {
      const double x = i / 8.0 - 1, y = k / 8.0 - 1;
      m.vertices.push_back({x, y, 0.2 * std::sin(7 * x + 0.3) * std::cos(8 * y)});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = i * (n + 1) + k, b = a + n + 1;
      m.triangles.push_back({a, b, b + 1});
      m.triangles.push_back({a, b + 1, a + 1});
    }
  return m;
}

// A square frame about the z axis, `thick` along it: closed, with edges and corners of both kinds.
TriangleMesh frame(double outer, double inner, double thick) {
  TriangleMesh m;
  for (const double z : {-thick / 2, thick / 2})
    for (const double half : {outer, inner})
      for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
        m.vertices.push_back({half * x, half * y, z});
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    quad(next, k, 4 + k, 4 + next);            // below
    quad(8 + k, 8 + next, 12 + next, 12 + k);  // above
    quad(k, next, 8 + next, 8 + k);            // outside
    quad(4 + next, 4 + k, 12 + k, 12 + next);  // inside the hole
  }
  return m;
}

// The mesh that is seen from inside: its normals are inwards.
TriangleMesh inside_out(TriangleMesh m) {
  for (auto& t : m.triangles) std::swap(t[1], t[2]);
  return m;
}

double distance_to(const NearWalls& near, Vec3d x) {
  double least = R;
  for (const NearFacet& f : near.facet) {
    particles::WallContact contact;
    if (particles::touch_triangle(particles::Facet{f.a, f.b, f.c, f.normal}, x, R, contact))
      least = std::min(least, contact.gap + R);
  }
  return least;
}

// The separating planes leave out only facets that hide nothing.
TEST(SeenFacets, AreThoseThatAllOthersLeaveInSight) {
  const Walls walls(
      {waves(), transformed(box_mesh({0.15, 0.15, 0.1}), Pose{{0.1, 0.05, 0.3}, {}}), frame(0.5, 0.2, 0.05)},
      R);
  Random random;
  NearWalls near;
  double most = 0;
  int facets = 0;
  for (int k = 0; k < 60; ++k) {
    const Vec3d x = random.in_box(0.6);
    walls.find(x, R, near);
    if (distance_to(near, x) < 0.02) continue;
    most = std::max(most, difference(seen(x, near), cut_by_all(x, near)));
    facets += near.count;
  }
  EXPECT_GT(facets, 1000);
  EXPECT_LT(most, 5e-12);
}

TEST(SeenFacets, OfClosedSurfacesFaceThePoint) {
  const TriangleMesh mesh =
      transformed(frame(0.5, 0.2, 0.05), Pose{{0.01, 0.02, 0}, Quat{1, 0.2, 0.1, 0.3}.normalized()});
  for (const bool inwards : {false, true}) {
    const Walls walls({inwards ? inside_out(mesh) : mesh}, R);
    Random random;
    NearWalls all, near;
    int dropped = 0, undecided = 0, points = 0;
    for (int k = 0; k < 2000; ++k) {
      const Vec3d x = random.in_box(0.7);
      walls.find(x, R, all);
      if (distance_to(all, x) < 1e-3 || distance_to(all, x) >= R) continue;
      ++points;
      const auto count = static_cast<std::uint32_t>(all.count);
      const int side = side_of_surface(
                    x, [&all](std::uint32_t facet) -> const NearFacet& { return all.facet[facet]; }, count, 1,
                    R),
                expected = (winding_number(mesh, x) < 0.5) != inwards ? 1 : -1;
      EXPECT_TRUE(side == 0 || side == expected) << x.x << " " << x.y << " " << x.z;
      const bool mixed = std::ranges::any_of(all.facet, [](const NearFacet& f) { return f.height > 0; }) &&
                         std::ranges::any_of(all.facet, [](const NearFacet& f) { return f.height < 0; });
      undecided += mixed && side == 0;
      if (k % 20 != 0) continue;
      walls.find_seen(x, R, near);
      dropped += all.count - near.count;
      // Shadows begin 1e-6 R behind facets: through such gaps some of the backs is in sight.
      EXPECT_LT(difference(seen(x, near), seen(x, all)), 1e-5);
    }
    EXPECT_GT(points, 700);
    EXPECT_LE(undecided, points / 100);
    EXPECT_GT(dropped, 200);
  }
}

std::vector<std::uint32_t> surfaces_of(const TriangleMesh& mesh) {
  return Walls({mesh}, R).surface();
}

TEST(ClosedSurfaces, AreFoundOnlyWhereTheyAreClosedAndOriented) {
  const TriangleMesh ring = frame(0.5, 0.2, 0.05);
  EXPECT_EQ(surfaces_of(ring), std::vector<std::uint32_t>(32, 1));
  TriangleMesh open = ring;
  open.triangles.pop_back();
  EXPECT_EQ(surfaces_of(open), std::vector<std::uint32_t>(31, 0));
  TriangleMesh turned = ring;
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_EQ(surfaces_of(turned), std::vector<std::uint32_t>(32, 0));
  // A corner that is pushed through the other side: from some points both sides of its facets are seen.
  TriangleMesh pushed = box_mesh({1, 1, 1});
  for (Vec3d& v : pushed.vertices)
    if (v.x > 0 && v.y > 0 && v.z > 0) v = {-0.2, -0.3, -0.9};
  EXPECT_EQ(surfaces_of(pushed), std::vector<std::uint32_t>(pushed.triangles.size(), 0));
  // Two boxes in one mesh, and a sheet beside them.
  TriangleMesh two = box_mesh({1, 1, 1});
  const TriangleMesh other = transformed(box_mesh({1, 1, 1}), Pose{{2, 0, 0}, {}});
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  ASSERT_EQ(other.vertices.size(), 8u);
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  two.vertices.push_back({0, 0, 5});
  two.triangles.push_back({0, 1, 16});
  std::vector<std::uint32_t> expected(25, 1);
  std::fill_n(expected.begin(), 12, 0);
  expected[24] = 0;
  EXPECT_EQ(surfaces_of(two), expected) << "the sheet joins the first box";
  // Each body has its own.
  EXPECT_EQ(Walls({ring, other}, R).surface().back(), 2u);
}

// A disc of 600 needles is the polygon of its rim.
TEST(SeenFacets, MayBeManyMoreThanAHundred) {
  constexpr int segments = 600;
  const TriangleMesh tank = cylinder_mesh(0.2, 2, segments, {"+z"});
  const Walls walls({tank}, R);
  std::vector<Vec3d> rim;
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    rim.push_back({0.2 * std::cos(angle), 0.2 * std::sin(angle), -1});
  }
  const Vec3d x{0.03, -0.02, -0.93};
  NearWalls near;
  walls.find_seen(x, R, near);
  EXPECT_GT(near.count, segments);
  bool complete = true;
  FacetIntegrals disc;
  for (int k = 0; k < near.count; ++k)
    if (const NearFacet& f = near.facet[static_cast<std::size_t>(k)]; std::fabs(f.normal.z) > 0.5)
      disc += seen_integrals(x, near, k, kernel, complete);
  const FacetIntegrals expected = facet_integrals(x, rim.data(), segments, {0, 0, 1}, kernel);
  EXPECT_TRUE(complete);
  EXPECT_NEAR(disc.surface, expected.surface, 1e-11 * expected.surface);
  EXPECT_NEAR(disc.shadow, expected.shadow, 1e-11);
}

// A floor behind tiles that do not touch each other: what is seen is the floor without the shadows of the
// tiles.
TEST(SeenFacets, AreWholeBehindHundredsOfOthers) {
  constexpr int n = 20;
  constexpr double half = 0.6, above = 0.05, pitch = 0.4 / n;
  const Vec3d x{0.013, -0.021, 0.11};
  TriangleMesh floor, tiles;
  floor.vertices = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  FacetIntegrals expected = facet_integrals(x, floor.vertices.data(), 4, {0, 0, 1}, kernel);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const auto first = static_cast<std::uint32_t>(tiles.vertices.size());
      const double u = (i - 0.5 * n + 0.1) * pitch, w = (k - 0.5 * n + 0.15) * pitch, size = 0.7 * pitch;
      Vec3d shadow[4];
      int corner = 0;
      for (const Vec3d at : {Vec3d{u, w, above}, Vec3d{u + size, w, above}, Vec3d{u + size, w + size, above},
                             Vec3d{u, w + size, above}}) {
        tiles.vertices.push_back(at);
        shadow[corner++] = x + (x.z / (x.z - above)) * (at - x);
      }
      tiles.triangles.push_back({first, first + 1, first + 2});
      tiles.triangles.push_back({first, first + 2, first + 3});
      const FacetIntegrals hidden = facet_integrals(x, shadow, 4, {0, 0, 1}, kernel);
      expected.surface -= hidden.surface;
      expected.shadow -= hidden.shadow;
      expected.moment -= hidden.moment;
    }
  const Walls walls({tiles, floor}, R);
  NearWalls near;
  walls.find_seen(x, R, near);
  EXPECT_GT(near.count, 400);
  bool complete = true;
  FacetIntegrals sum;
  for (int k = 0; k < near.count; ++k)
    if (near.facet[static_cast<std::size_t>(k)].body == 1)
      sum += seen_integrals(x, near, k, kernel, complete);
  EXPECT_TRUE(complete);
  EXPECT_GT(expected.surface * R, 0.01);
  EXPECT_NEAR(sum.surface * R, expected.surface * R, 1e-9);
  EXPECT_NEAR(sum.shadow, expected.shadow, 1e-9);
  EXPECT_NEAR(norm(sum.moment - expected.moment), 0, 1e-9);
}

// The pieces of a triangle add up to it.
TEST(VisiblePart, FallsIntoPieces) {
  const Vec3d corner[3] = {{-0.1, -0.05, 0}, {0.15, -0.1, 0}, {0.02, 0.2, 0}}, x{0.03, 0.01, 0.06};
  const FacetIntegrals whole = facet_integrals(x, corner, 3, {0, 0, 1}, kernel);
  for (const int n : {1, 2, 5}) {
    FacetIntegrals sum;
    int pieces = 0;
    for_pieces(corner, n, [&](const Polygon& p) {
      sum += facet_integrals(x, p.corner.data(), p.count, {0, 0, 1}, kernel);
      ++pieces;
    });
    EXPECT_EQ(pieces, n * n);
    EXPECT_NEAR(sum.surface, whole.surface, 1e-12);
    EXPECT_NEAR(norm(sum.rim - whole.rim), 0, 1e-12);
  }
}

}  // namespace
}  // namespace tandem::test
