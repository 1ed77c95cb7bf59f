#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tests/unit/dem_geometry/walls.hpp"

namespace tandem::particles::test {
namespace {

using std::numbers::pi;

double segment_distance(Vec3d p, Vec3d a, Vec3d b) {
  const double t = std::clamp(dot(p - a, b - a) / norm2(b - a), 0.0, 1.0);
  return norm(p - (a + t * (b - a)));
}

// Smallest of the distances to the three edges and, where the foot of the perpendicular is inside, to the
// plane.
double reference_distance(const Facet& t, Vec3d p) {
  double d =
      std::min({segment_distance(p, t.a, t.b), segment_distance(p, t.b, t.c), segment_distance(p, t.c, t.a)});
  const Vec3d n = normalized(cross(t.b - t.a, t.c - t.a));
  const Vec3d foot = p - dot(n, p - t.a) * n;
  const bool inside = dot(n, cross(t.b - t.a, foot - t.a)) >= 0 &&
                      dot(n, cross(t.c - t.b, foot - t.b)) >= 0 && dot(n, cross(t.a - t.c, foot - t.c)) >= 0;
  return inside ? std::min(d, std::abs(dot(n, p - t.a))) : d;
}

TEST(TouchTriangle, IsTheReferenceForRandomTriangles) {
  Random random(1);
  int contacts_found = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3d a = random.vector(-1, 1), b = random.vector(-1, 1);
    const Facet t = triangle_facet(a, b, random.vector(-1, 1));
    if (norm(cross(t.b - t.a, t.c - t.a)) < 1e-3) continue;
    const Vec3d p = random.vector(-1.5, 1.5);
    const double radius = random(0.1, 1), distance = reference_distance(t, p);
    WallContact c;
    const bool touches = touch_triangle(t, p, radius, c);
    if (std::abs(distance - radius) > 1e-12) {
      ASSERT_EQ(touches, distance < radius) << i;
    }
    if (!touches) continue;
    ++contacts_found;
    ASSERT_NEAR(c.gap, distance - radius, 1e-12) << i;
    ASSERT_NEAR(norm(c.normal), 1, 1e-14);
    ASSERT_NEAR(norm(c.point + (c.gap + radius) * c.normal - p), 0, 1e-12);
  }
  EXPECT_GT(contacts_found, 20000);
}

TEST(TouchTriangle, KeepsItsDigitsOnSliversAndHugeTriangles) {
  // A sphere of radius 1 on a sliver of aspect 1e7, and on a triangle a thousand times larger than the
  // sphere.
  for (const Facet& t : {triangle_facet({-5, 0, 0}, {5, 0, 0}, {0, 1e-6, 0}),
                         triangle_facet({-1e3, -1e3, 0}, {1e3, -1e3, 0}, {0, 2e3, 0})}) {
    WallContact c;
    for (const double z : {0.99, -0.99, 1e-3}) {
      ASSERT_TRUE(touch_triangle(t, {0.3, 2e-7, z}, 1, c));
      EXPECT_NEAR(c.gap, std::abs(z) - 1, 1e-13);
      EXPECT_NEAR(c.normal.z, z > 0 ? 1 : -1, 1e-13);
    }
  }
}

TEST(TouchTriangle, CentreOnTheTriangleIsPushedAlongItsNormal) {
  const Facet t = triangle_facet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (const Vec3d p : {Vec3d{0.2, 0.2, 0}, Vec3d{0, 0, 0}, Vec3d{0.5, 0, 0}, Vec3d{0.5, 0.5, 0}}) {
    WallContact c;
    ASSERT_TRUE(touch_triangle(t, p, 0.1, c));
    EXPECT_NEAR(c.normal.z, 1, 1e-15);
    EXPECT_NEAR(c.gap, -0.1, 1e-15);
  }
}

TEST(TouchPlane, PushesOutFromBothSides) {
  const Surface s = surface_of({wall("floor", scene::PlaneShape{{0, 0, 2}, {0, 0, 1}})}, 1);
  EXPECT_TRUE(contacts(s, {50, -70, 3.1}, 1).empty());
  for (const double z : {2.9, 2.0, 1.5, -3.0}) {
    const auto found = contacts(s, {50, -70, z}, 1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].normal, (Vec3d{0, 0, 1}));
    EXPECT_DOUBLE_EQ(found[0].gap, z - 2 - 1);
  }
}

// ---- coplanar tessellations

// The square [-1, 1]^2 in many tessellations.
std::map<std::string, TriangleMesh> squares() {
  std::map<std::string, TriangleMesh> meshes;
  const auto grid = [](int n, double shift) {
    TriangleMesh m;
    Random random(7);
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const bool inner = i > 0 && j > 0 && i < n && j < n;
        const double dx = inner ? random(-shift, shift) / n : 0, dy = inner ? random(-shift, shift) / n : 0;
        m.vertices.push_back({-1 + 2.0 * i / n + dx, -1 + 2.0 * j / n + dy, 0});
      }
    }
    const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        // Windings differ, because both sides of a triangle are walls.
        m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        m.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      }
    }
    return m;
  };
  meshes["two triangles"] = grid(1, 0);
  meshes["coarse"] = grid(4, 0.4);
  meshes["fine"] = grid(60, 0.4);
  TriangleMesh fan;  // slivers about a vertex
  fan.vertices.push_back({0.1, 0.2, 0});
  for (int i = 0; i < 200; ++i) {
    const double a = 2 * pi * i / 200, x = std::cos(a), y = std::sin(a),
                 m = std::max(std::abs(x), std::abs(y));
    fan.vertices.push_back({x / m, y / m, 0});
    fan.triangles.push_back(
        {0, static_cast<std::uint32_t>(1 + i), static_cast<std::uint32_t>(1 + (i + 1) % 200)});
  }
  meshes["fan"] = fan;
  TriangleMesh soup = grid(10, 0.4), apart;  // every triangle with its own vertices, as in STL
  for (const auto& t : soup.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t v : t) apart.vertices.push_back(soup.vertices[v]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  meshes["soup"] = apart;
  return meshes;
}

TEST(Tessellation, AnyFlatMeshIsThePlane) {
  const Quat rotate_spring = exp({0.4, -0.7, 0.2});
  for (const auto& [name, flat] : squares()) {
    for (const Pose& pose : {Pose{}, Pose{{0.3, -2, 5}, rotate_spring}}) {
      const Surface s = mesh_surface(transformed(flat, pose), 0.12);
      EXPECT_EQ(s.patches.size(), 1u) << name;
      const Vec3d normal = pose.q_WB.rotate({0, 0, 1});
      Random random(3);
      for (int i = 0; i < 3000; ++i) {
        const double radius = random(0.005, 0.11), overlap = random(1e-6, 0.3) * radius,
                     side = i % 2 ? 1 : -1;
        Vec3d at{random(-0.95, 0.95), random(-0.95, 0.95), 0};
        const auto& t = flat.triangles[static_cast<std::size_t>(i) % flat.triangles.size()];
        const auto vertex = [&](std::size_t k) { return flat.vertices[t[k]]; };
        if (i % 3 == 1) at = vertex(0) + random(0, 1) * (vertex(1) - vertex(0));
        if (i % 3 == 2) at = vertex(0);
        const auto found =
            contacts(s, pose.p_WB + pose.q_WB.rotate(at + Vec3d{0, 0, side * (radius - overlap)}), radius);
        ASSERT_EQ(found.size(), 1u) << name << " " << i;
        const bool rim = std::max(std::abs(at.x), std::abs(at.y)) > 0.999999;  // the mesh ends there
        ASSERT_NEAR(norm(found[0].normal - side * normal), 0, rim ? 1e-9 : 5e-13) << name << " " << i;
        ASSERT_NEAR(found[0].gap, -overlap, 1e-13) << name << " " << i;
      }
    }
  }
}

TEST(Tessellation, SeparateFlatWallsAreOneContact) {
  // Two adjacent plates, as two walls of two materials.
  scene::Wall left = wall("left", scene::BoxShape{{1, 1, 0.1}, {}}, ground, {{-0.5, 0, -0.05}, {}});
  scene::Wall right = wall("right", scene::BoxShape{{1, 1, 0.1}, {}}, ground, {{0.5, 0, -0.05}, {}});
  const Surface s = surface_of({left, right}, 0.2);
  for (const double x : {-0.3, -0.05, -1e-9, 0.0, 1e-9, 0.05, 0.3}) {
    const auto found = contacts(s, {x, 0.1, 0.19}, 0.2);
    ASSERT_EQ(found.size(), 1u) << x;
    EXPECT_NEAR(found[0].normal.z, 1, 1e-14);
    EXPECT_NEAR(found[0].gap, -0.01, 1e-14);
  }
}

TEST(Tessellation, FineRampBesideAFloorAddsNoContactBeforeItIsReached) {
  // A ramp in strips that rises by 35 degrees from x = 0. A sphere in front of it is in contact with the
  // floor alone.
  TriangleMesh m;
  const double c = std::cos(35 * pi / 180), si = std::sin(35 * pi / 180);
  std::vector<Vec3d> line{{-1, 0, 0}};
  for (int i = 0; i <= 100; ++i) line.push_back({0.01 * i * c, 0, 0.01 * i * si});
  for (const Vec3d& v : line) {
    m.vertices.push_back({v.x, -1, v.z});
    m.vertices.push_back({v.x, 1, v.z});
  }
  for (std::uint32_t i = 0; i + 1 < line.size(); ++i) {
    m.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 2});
    m.triangles.push_back({2 * i + 1, 2 * i + 3, 2 * i + 2});
  }
  const Surface s = mesh_surface(m, 0.12);
  ASSERT_EQ(s.patches.size(), 2u);
  const double radius = 0.1, overlap = 0.002, z = radius - overlap;
  for (double x = -0.2; x < 0.1; x += 0.0007) {
    const auto found = contacts(s, {x, 0.03, z}, radius);
    // Distance to the ramp's line; the foot of the perpendicular must be beyond the crease.
    const double ramp = z * c - x * si;
    const bool on_ramp = ramp < radius && x * c + z * si > 0;
    const bool floor = x <= 0 || norm(Vec3d{x, 0, z}) < radius;
    if (std::abs(ramp - radius) < 1e-9) continue;
    if (x <= 0) {
      ASSERT_EQ(found.size(), on_ramp ? 2u : 1u) << x;
    }
    if (on_ramp) {
      double deepest = 0;
      for (const auto& k : found) deepest = std::min(deepest, k.gap);
      ASSERT_LE(deepest, ramp - radius + 1e-12);
    }
    ASSERT_TRUE(floor || on_ramp);
  }
}

// ---- edges and corners

TEST(Corner, BoxFromInsideHasOneContactPerFace) {
  const Surface s = surface_of({wall("box", scene::BoxShape{{2, 2, 2}, {}})}, 0.2);
  ASSERT_EQ(s.patches.size(), 6u);
  const double r = 0.2;
  auto found = contacts(s, {0.81, 0.82, -0.83}, r);
  ASSERT_EQ(found.size(), 3u);  // deepest first
  EXPECT_EQ(found[0].normal, (Vec3d{0, 0, 1}));
  EXPECT_EQ(found[1].normal, (Vec3d{0, -1, 0}));
  EXPECT_EQ(found[2].normal, (Vec3d{-1, 0, 0}));
  EXPECT_NEAR(found[0].gap, -0.03, 1e-15);
  EXPECT_NEAR(found[1].gap, -0.02, 1e-15);
  EXPECT_NEAR(found[2].gap, -0.01, 1e-15);
  for (double d : {0.0, 0.3, -0.8}) {
    EXPECT_EQ(contacts(s, {0.81, d / 2, -0.83}, r).size(), 2u);
    EXPECT_EQ(contacts(s, {d, d / 3, -0.83}, r).size(), 1u + (d < -0.79));
  }
  EXPECT_TRUE(contacts(s, {0.1, 0.2, 0.3}, r).empty());
}

TEST(Corner, OfABoxNeedsNoList) {
  const Surface s = surface_of({wall("box", scene::BoxShape{{2, 2, 2}, {}})}, 0.2);
  const auto few = [&](Vec3d centre) {
    FewWallContacts found;
    const NearFacets near = near_facets(s.grids[0], s.cell_start.data(), s.cell_facet.data(), centre);
    return collect_few_wall_contacts(centre, 0.2, near, near.count, s.facets.data(), found);
  };
  EXPECT_EQ(few({0.81, 0.82, -0.83}), 3);  // from inside
  EXPECT_EQ(few({1.1, 1.05, 1.08}), 1);    // from outside
}

TEST(Corner, BoxFromOutsideHasOneContact) {
  const Surface s = surface_of({wall("box", scene::BoxShape{{2, 2, 2}, {}})}, 0.3);
  Random random(5);
  int found_some = 0;
  for (int i = 0; i < 50000; ++i) {
    const Vec3d p = random.vector(-1.3, 1.3);
    const Vec3d on{std::clamp(p.x, -1.0, 1.0), std::clamp(p.y, -1.0, 1.0), std::clamp(p.z, -1.0, 1.0)};
    const double distance = norm(p - on), r = random(0.05, 0.3);
    if (distance < 0.5 * r) continue;  // outside, and not deep
    const auto found = contacts(s, p, r);
    ASSERT_EQ(found.size(), distance < r ? 1u : 0u) << p.x << " " << p.y << " " << p.z << " r " << r;
    if (found.empty()) continue;
    ++found_some;
    ASSERT_NEAR(found[0].gap, distance - r, 1e-13);
    ASSERT_NEAR(norm(found[0].normal - normalized(p - on)), 0, 1e-12);
  }
  EXPECT_GT(found_some, 1000);
}

TEST(Corner, ConcaveEdgesHaveTwoContactsDownToTheSmoothAngle) {
  // Two plates meet at the line y = 0 at the angle `bend`; the sphere is in the middle.
  for (const double bend : {26.0, 30.0, 45.0, 90.0, 120.0, 150.0, 170.0}) {
    const double half = bend / 2 * pi / 180;
    TriangleMesh m;
    const double c = 50 * std::cos(half), z = 50 * std::sin(half);
    m.vertices = {{0, -1, 0}, {0, 1, 0}, {c, -1, z}, {c, 1, z}, {-c, -1, z}, {-c, 1, z}};
    m.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}};
    const Surface s = mesh_surface(m, 0.1);
    ASSERT_EQ(s.patches.size(), 2u) << bend;
    const auto found = contacts(s, {0, 0.1, 0.099 / std::cos(half)}, 0.1);
    ASSERT_EQ(found.size(), 2u) << bend;
    for (const auto& k : found) {
      EXPECT_NEAR(k.gap, -0.001, 1e-13);
      EXPECT_NEAR(k.normal.z, std::cos(half), 1e-12);
    }
  }
}

TEST(Corner, ThinPlateTouchesOnTheSideOfTheCentre) {
  const Surface s = surface_of({wall("plate", scene::BoxShape{{2, 2, 0.01}, {}})}, 0.1);
  for (const double side : {1.0, -1.0}) {
    const auto found = contacts(s, {0.4, -0.3, side * 0.1}, 0.1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, -0.005, 1e-14);
    EXPECT_NEAR(found[0].normal.z, side, 1e-14);
  }
  const auto rim = contacts(s, {1.099, 0.3, 0.001}, 0.1);
  ASSERT_EQ(rim.size(), 1u);
  EXPECT_NEAR(rim[0].gap, -0.001, 1e-14);
  EXPECT_NEAR(rim[0].normal.x, 1, 1e-14);
}

TEST(Cylinder, InsideAndOutsideHaveOneContactNearTheRoundWall) {
  const double R = 1, r = 0.1;
  const int segments = 96;
  const double sagitta = R * (1 - std::cos(pi / segments));
  const Surface s = surface_of({wall("drum", scene::CylinderShape{R, 2, segments, {"+z", "-z"}})}, r);
  ASSERT_EQ(s.patches.size(), 1u);
  for (int i = 0; i < 1000; ++i) {
    const double a = 2 * pi * i / 1000, z = -0.9 + 0.0018 * i;
    const Vec3d out{std::cos(a), std::sin(a), 0};
    const auto inside = contacts(s, (R - r + 0.01) * out + Vec3d{0, 0, z}, r);
    const auto outside = contacts(s, (R + r - 0.01) * out + Vec3d{0, 0, z}, r);
    ASSERT_EQ(inside.size(), 1u) << i;
    ASSERT_EQ(outside.size(), 1u) << i;
    // The polygon is inside the circle, by at most the sagitta.
    ASSERT_LE(inside[0].gap, -0.01 + 1e-12);
    ASSERT_GE(inside[0].gap, -0.01 - 1.2 * sagitta);
    ASSERT_GE(outside[0].gap, -0.01 - 1e-12);
    ASSERT_LE(outside[0].gap, -0.01 + 1.2 * sagitta);
    ASSERT_GT(dot(outside[0].normal, out), std::cos(1.2 * pi / segments));
    ASSERT_GT(-dot(inside[0].normal, out), std::cos(1.2 * pi / segments));
  }
}

TEST(Cylinder, ItsEndsAreOtherPatches) {
  const Surface s = surface_of({wall("can", scene::CylinderShape{1, 2, 48, {}})}, 0.2);
  EXPECT_EQ(s.patches.size(), 3u);
  EXPECT_EQ(contacts(s, {0.81, 0, -0.82}, 0.2).size(), 2u);  // inside, where side and bottom join
  EXPECT_EQ(contacts(s, {1.1, 0, 1.1}, 0.2).size(), 1u);     // outside, at the rim
}

// ---- names

TEST(Name, StaysOnAnEdgeAndLeadsBackAfterIt) {
  const Surface s = surface_of({wall("box", scene::BoxShape{{2, 2, 2}, {}})}, 0.3);
  // On the edge of top and side, perturbed by rounding: one name.
  Random random(9);
  const std::uint32_t name = contacts(s, {1.1, 0.2, 1.1}, 0.2).at(0).patch;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p = Vec3d{1.1, 0.2, 1.1} + random.vector(-1e-3, 1e-3);
    ASSERT_EQ(contacts(s, p, 0.2).at(0).patch, name) << i;
  }
  // From the top over the edge down the side: the contact with a new name has the old name as its neighbour.
  std::uint32_t last = contacts(s, {0.95, 0.2, 1.19}, 0.2).at(0).patch;
  const std::uint32_t top = last;
  for (int i = 0; i <= 200; ++i) {
    const double a = (i - 20) * pi / 320;
    const Vec3d p = a < 0        ? Vec3d{1 + a, 0.2, 1.19}
                    : a > pi / 2 ? Vec3d{1.19, 0.2, 1 - (a - pi / 2)}
                                 : Vec3d{1 + 0.19 * std::sin(a), 0.2, 1 + 0.19 * std::cos(a)};
    const auto found = contacts(s, p, 0.2);
    ASSERT_EQ(found.size(), 1u) << i;
    ASSERT_TRUE(found[0].patch == last || found[0].neighbour == last) << i;
    last = found[0].patch;
  }
  EXPECT_NE(last, top);
}

TEST(Name, IsUniqueAcrossASlot) {
  // A sphere rests on both edges of a groove in a plate: the plate's top must not name both contacts.
  const scene::BoxShape bar{{1, 1, 1}, {}};
  TriangleMesh left = transformed(box_mesh(bar.size), {{-0.55, 0, -0.5}, {}});
  const TriangleMesh right = transformed(box_mesh(bar.size), {{0.55, 0, -0.5}, {}});
  const auto first = static_cast<std::uint32_t>(left.vertices.size());
  left.vertices.insert(left.vertices.end(), right.vertices.begin(), right.vertices.end());
  for (auto t : right.triangles) left.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  Surface s = mesh_surface(left, 0.3);
  // Both tops form one patch, the lowest, as on a plate with a groove.
  for (Facet& f : s.facets) {
    if (f.a.z == 0 && f.b.z == 0 && f.c.z == 0) {
      f.patch = 0;
    } else {
      ++f.patch;
    }
  }
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p{random(-1e-3, 1e-3), 0.1 + random(-0.1, 0.1), 0.17};
    const auto found = contacts(s, p, 0.2);
    ASSERT_EQ(found.size(), 2u) << i;
    EXPECT_NE(found[0].patch, found[1].patch);
    EXPECT_NE(found[0].patch, 0u);
    EXPECT_NE(found[1].patch, 0u);
  }
}

// ---- the rule itself

// The rule as docs/wall_contact.md states it: the deepest of each patch, then by depth those that no deeper
// one covers.
std::vector<std::uint32_t> rule(const std::vector<Facet>& facets, Vec3d p, double radius) {
  std::map<std::uint32_t, WallContact> deepest;
  for (std::uint32_t i = 0; i < facets.size(); ++i) {
    WallContact k;
    if (!touch_facet(facets.data(), i, p, radius, k)) continue;
    const auto [it, fresh] = deepest.try_emplace(k.patch, k);
    if (!fresh && deeper(k, it->second)) it->second = k;
  }
  std::vector<WallContact> order, kept;
  for (const auto& [patch, k] : deepest) order.push_back(k);
  std::sort(order.begin(), order.end(), deeper);
  for (const WallContact& k : order) {
    bool hidden = false;
    for (const WallContact& j : kept) hidden = hidden || covered(k, j, radius);
    if (!hidden) kept.push_back(k);
  }
  std::vector<std::uint32_t> result;
  for (const WallContact& k : kept) result.push_back(k.facet);
  return result;
}

TEST(Rule, PassesGiveWhatTheRuleSaysForRandomSoups) {
  Random random(11);
  std::map<std::size_t, int> sizes;
  for (int i = 0; i < 3000; ++i) {
    std::vector<Facet> facets;
    const int n = 1 + i % 40, patches = 1 + i % 13;
    for (int k = 0; k < n; ++k) {
      const Vec3d a = random.vector(-1, 1), b = random.vector(-1, 1), c = random.vector(-1, 1);
      Facet f = triangle_facet(a, b, c);
      f.patch = static_cast<std::uint32_t>(random(0, patches));
      if (k == n - 1 && i % 4 == 0) {
        f.kind = FacetKind::plane;
        f.normal = normalized(b);
        f.patch = static_cast<std::uint32_t>(patches);
      }
      facets.push_back(f);
    }
    std::vector<std::uint32_t> near(facets.size());
    for (std::uint32_t k = 0; k < near.size(); ++k) near[k] = k;
    const Vec3d p = random.vector(-0.5, 0.5);
    const double radius = random(0.1, 0.6);
    const auto expected = rule(facets, p, radius);
    WallContactSpace space;
    const int count =
        collect_wall_contacts(p, radius, near.data(), static_cast<int>(near.size()), facets.data(), space);
    const WallContact* out = space.contacts.data();
    ++sizes[expected.size()];
    if (expected.size() > max_wall_contacts) {
      ASSERT_EQ(count, wall_contact_overflow);
      continue;
    }
    ASSERT_EQ(static_cast<std::size_t>(count), expected.size()) << i;
    check_few(p, radius, near.data(), n, facets, {out, out + count});
    for (int k = 0; k < count; ++k) ASSERT_EQ(out[k].facet, expected[static_cast<std::size_t>(k)]) << i;
    for (int k = 0; k < count; ++k) {
      for (int l = 0; l < k; ++l) ASSERT_NE(out[k].patch, out[l].patch) << i;
    }
  }
  EXPECT_GT(sizes[2] + sizes[3], 500);
}

TEST(Rule, MoreContactsThanPlacesAreTold) {
  const Surface s = surface_of({wall("box", scene::BoxShape{{0.3, 0.3, 0.3}, {}})}, 0.2);
  WallContactSpace space;
  const NearFacets near = near_facets(s.grids[0], s.cell_start.data(), s.cell_facet.data(), {});
  EXPECT_EQ(collect_wall_contacts(Vec3d{}, 0.2, near, near.count, s.facets.data(), space, 4),
            wall_contact_overflow);
  EXPECT_EQ(contacts(s, {}, 0.2).size(), 6u);
}

}  // namespace
}  // namespace tandem::particles::test
