// The kernel, and its integrals over facets and their shadows, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "sph_server/kernel/common_edge.hpp"
#include "sph_server/kernel/facet_integrals.hpp"
#include "sph_server/kernel/visible_part.hpp"
#include "sph_server/kernel/wendland.hpp"

namespace tandem::test {
namespace {

using namespace sph;
constexpr double pi = std::numbers::pi;

TEST(WendlandKernel, IntegratesToOne) {
  const auto kernel = Kernel<double>::of_support(0.3);
  double sum = 0;
  constexpr int n = 20'000;
  for (int k = 0; k < n; ++k) {
    const double r = 0.3 * (k + 0.5) / n;
    sum += 4 * pi * r * r * kernel.value(r) * 0.3 / n;
  }
  EXPECT_NEAR(sum, 1, 1e-8);
}

TEST(WendlandKernel, HasTheGradientOfItsValue) {
  const auto kernel = Kernel<double>::of_support(0.3);
  for (const double r : {0.01, 0.1, 0.2, 0.29}) {
    const double slope = (kernel.value(r + 1e-6) - kernel.value(r - 1e-6)) / 2e-6;
    EXPECT_NEAR(kernel.gradient_by_distance(r) * r, slope, 1e-6 * kernel.value(0) / 0.3);
  }
}

// A square of edge 2 a about the origin, in the plane z = 0.
FacetIntegrals square(Vec3d x, double a, const WallKernel& kernel) {
  const Vec3d corner[4] = {{-a, -a, 0}, {a, -a, 0}, {a, a, 0}, {-a, a, 0}};
  return facet_integrals(x, corner, 4, {0, 0, 1}, kernel);
}

TEST(FacetIntegrals, OfAPlaneHaveTheirClosedForm) {
  const double R = 0.3;
  const WallKernel kernel = WallKernel::of(R, 0);
  for (const double s : {1e-9, 0.1, 0.5, 0.9}) {
    // The integral of W over a plane is 21/R times the integral of (1 - s)^4 (1 + 4 s) s from s to 1.
    const double surface = 21 / R *
                           (1.0 / 14 - s * s / 2 + 2.5 * std::pow(s, 4) - 4 * std::pow(s, 5) +
                            2.5 * std::pow(s, 6) - 4.0 / 7 * std::pow(s, 7));
    // Its integral over the distance is that of W over the half-space.
    const auto primitive = [](double t) {
      return t / 14 - std::pow(t, 3) / 6 + std::pow(t, 5) / 2 - 2 * std::pow(t, 6) / 3 +
             2.5 * std::pow(t, 7) / 7 - std::pow(t, 8) / 14;
    };
    for (const double side : {1.0, -1.0}) {
      const FacetIntegrals f = square({0.02, -0.01, side * s * R}, 10 * R, kernel);
      EXPECT_NEAR(f.surface, surface, 1e-12 / R);
      EXPECT_NEAR(f.shadow, 21 * (primitive(1) - primitive(s)), 1e-12);
      EXPECT_NEAR(f.moment.z, -side * s * R * surface, 1e-12);
      EXPECT_NEAR(f.moment.x, 0, 1e-12);
    }
  }
}

TEST(FacetIntegrals, AddUpOverParts) {
  const WallKernel kernel = WallKernel::of(0.3, 0.1);
  const Vec3d x{0.03, 0.02, 0.1};
  const FacetIntegrals whole = square(x, 0.2, kernel);
  FacetIntegrals sum;
  // A fan about a point, once at its foot and once elsewhere.
  for (const Vec3d centre : {Vec3d{0.03, 0.02, 0}, Vec3d{0.15, -0.17, 0}}) {
    sum = {};
    const Vec3d corner[4] = {{-0.2, -0.2, 0}, {0.2, -0.2, 0}, {0.2, 0.2, 0}, {-0.2, 0.2, 0}};
    for (int k = 0; k < 4; ++k) {
      const Vec3d triangle[3] = {centre, corner[k], corner[(k + 1) % 4]};
      sum += facet_integrals(x, triangle, 3, {0, 0, 1}, kernel);
    }
    EXPECT_NEAR(sum.surface, whole.surface, 1e-11);
    EXPECT_NEAR(sum.shadow, whole.shadow, 1e-12);
    EXPECT_NEAR(norm(sum.moment - whole.moment), 0, 1e-12);
  }
}

// The shadow of a plate is what lines from x through it reach. Its facets and its sides together give the
// integral of the gradient of W over it.
TEST(FacetIntegrals, WithTheirRimAreTheGradientOverTheShadow) {
  const double R = 0.3, a = 0.06;
  const WallKernel kernel = WallKernel::of(R, 0);
  const auto W = Kernel<double>::of_support(R);
  for (const Vec3d x : {Vec3d{0.02, 0.01, 0.05}, Vec3d{0.09, -0.02, 0.04}, Vec3d{0.08, 0.1, -0.06}}) {
    const FacetIntegrals plate = square(x, a, kernel);
    const Vec3d n{0, 0, x.z < 0 ? -1.0 : 1.0}, measured = plate.surface * n + plate.rim;
    Vec3d expected;
    constexpr int cells = 231;
    const double edge = 2 * R / cells;
    for (int i = 0; i < cells * cells * cells; ++i) {
      const Vec3d to_y =
          edge * Vec3d{i % cells + 0.5, i / cells % cells + 0.5, i / cells / cells + 0.5} - Vec3d{R, R, R};
      const double r = norm(to_y), part = -x.z / to_y.z;
      if (r >= R || !(part > 0 && part < 1)) continue;
      const Vec3d at = x + part * to_y;
      if (std::fabs(at.x) < a && std::fabs(at.y) < a)
        expected += (W.gradient_by_distance(r) * edge * edge * edge) * to_y;
    }
    std::printf("S n + rim of a plate, expected (%.4f, %.4f, %.4f) measured (%.4f, %.4f, %.4f) [1/R]\n",
                R * expected.x, R * expected.y, R * expected.z, R * measured.x, R * measured.y,
                R * measured.z);
    EXPECT_NEAR(R * norm(measured - expected), 0, 8e-3);
  }
  // Seen edge-on, the plate hides nothing.
  const FacetIntegrals edge_on = square({0.09, 0.01, 1e-9}, a, kernel);
  EXPECT_GT(R * edge_on.surface, 0.2);
  EXPECT_NEAR(R * norm(edge_on.surface * Vec3d{0, 0, 1} + edge_on.rim), 0, 1e-6);
}

// A particle beside a sheet may be in its plane up to rounding, on a side that only the height tells.
TEST(FacetIntegrals, OfATriangleSeenEdgeOnAreNoneWhateverTheRounding) {
  const double R = 0.03;
  const WallKernel kernel = WallKernel::of(R, 0.01);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> from(-1, 1);
  const auto any = [&] { return Vec3d{from(random), from(random), from(random)}; };
  int below = 0;
  double largest = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Vec3d origin = any(), u = normalized(any()), w = normalized(cross(u, any()));
    const auto at = [&](double s, double t) { return origin + s * R * u + t * R * w; };
    const Vec3d corner[3] = {at(0, from(random)), at(1, from(random)), at(1, from(random) + 2)},
                x = at(-0.05 - 0.5 * std::fabs(from(random)), from(random));
    const Vec3d n = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
    const double height = dot(x - corner[0], n);
    const FacetIntegrals f = facet_integrals(x, corner, 3, n, kernel);
    largest = std::fmax(largest, R * norm(f.surface * (height < 0 ? -n : n) + f.rim));
    below += height < 0 ? 1 : 0;
  }
  EXPECT_GT(below, 1000);
  std::printf("S n + rim of triangles seen edge-on: largest expected 0 measured %.3g tolerance 1e-11 [1/R]\n",
              largest);
  EXPECT_LT(largest, 1e-11);
}

// The particles of a lattice are above the diagonals of the faces of a box, up to rounding.
TEST(FacetIntegrals, OfTwoTrianglesAreThoseOfTheirRectangleAlsoAboveTheDiagonal) {
  const double spacing = 0.01, R = 3 * spacing;
  const WallKernel kernel = WallKernel::of(R, spacing);
  const Vec3d corner[4] = {
      {0, 0, 0}, {4 * spacing, 0, 0}, {4 * spacing, 28 * spacing, 0}, {0, 28 * spacing, 0}};
  double largest = 0;
  for (const double height : {0.5 * spacing, 1.5 * spacing, 2.5 * spacing})
    for (int k = -60; k <= 60; ++k) {
      const double aside = k == 0 ? 0 : std::copysign(std::pow(10.0, -std::abs(k) / 3.0 - 3), k);
      const Vec3d x{0.5 * spacing + aside, 3.5 * spacing, height}, n{0, 0, 1};
      const Vec3d one[3] = {corner[0], corner[1], corner[2]}, other[3] = {corner[0], corner[2], corner[3]};
      FacetIntegrals sum = facet_integrals(x, one, 3, n, kernel);
      sum += facet_integrals(x, other, 3, n, kernel);
      const FacetIntegrals whole = facet_integrals(x, corner, 4, n, kernel);
      largest = std::fmax(largest, std::fabs(sum.surface - whole.surface) * R);
      largest = std::fmax(largest, norm(sum.moment - whole.moment));
      largest = std::fmax(largest, std::fabs(sum.shadow - whole.shadow));
    }
  std::printf(
      "two triangles and their rectangle: largest difference expected 0 measured %.3g tolerance 1e-11\n",
      largest);
  EXPECT_LT(largest, 1e-11);
}

// What the walls of a closed box hide is the integral of the kernel over everything outside, and the gradient
// of that integral is the sum of -S n.
TEST(FacetIntegrals, OfABoxAreTheKernelOutsideOfIt) {
  const double a = 0.1, R = 0.3;
  const WallKernel kernel = WallKernel::of(R, 0);
  const auto hidden = [&](Vec3d x, Vec3d* gradient) {
    double sum = 0;
    Vec3d rim;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        Vec3d n{}, u{}, w{};
        n[axis] = -side;
        u[(axis + 1) % 3] = a;
        w[(axis + 2) % 3] = a;
        const Vec3d centre = -a * n;
        const Vec3d corner[4] = {centre - u - w, centre + u - w, centre + u + w, centre - u + w};
        const FacetIntegrals f = facet_integrals(x, corner, 4, normalized(cross(u, w)), kernel);
        sum += f.shadow;
        rim += f.rim;
        if (gradient != nullptr) *gradient -= f.surface * n;
      }
    EXPECT_NEAR(R * norm(rim), 0, 1e-12) << "its faces join";
    return sum;
  };
  const auto W = Kernel<double>::of_support(R);
  double inside = 0;
  constexpr int n = 100;
  const Vec3d x{0.04, -0.03, 0.05};
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3d y = (2 * a / n) * Vec3d{i % n + 0.5, i / n % n + 0.5, i / n / n + 0.5} - Vec3d{a, a, a};
    if (const double r = norm(y - x); r < R) inside += W.value(r) * std::pow(2 * a / n, 3);
  }
  Vec3d gradient{};
  EXPECT_NEAR(hidden(x, &gradient), 1 - inside, 1e-4);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d step{};
    step[axis] = 1e-5;
    EXPECT_NEAR(gradient[axis], (hidden(x + step, nullptr) - hidden(x - step, nullptr)) / 2e-5, 1e-6 / R);
  }
}

// A sheet x = 0 stands on the floor z = 0. What x sees of the floor ends at the sheet.
TEST(VisiblePart, OfAFloorEndsAtASheet) {
  const WallKernel kernel = WallKernel::of(0.3, 0);
  const Vec3d x{0.07, 0, 0.1};
  Polygon floor;
  floor.count = 4;
  const Vec3d corner[4] = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  for (int k = 0; k < 4; ++k) floor.corner[k] = corner[k];
  // The sheet is two triangles that extend below the floor.
  const Vec3d a{0, -2, -1}, b{0, 2, -1}, c{0, 2, 2}, d{0, -2, 2}, behind{-0.05, 0, 0}, normal{1, 0, 0};
  const Shadow shadows[3] = {Shadow::of(x, a, b, c, normal, 1e-9), Shadow::of(x, a, c, d, normal, 1e-9),
                             Shadow::of(x, a + behind, b + behind, c + behind, normal, 1e-9)};
  const auto seen_past = [&](int hiders) {
    FacetIntegrals sum;
    const auto shadow = [&](int k) { return shadows[k]; };
    VisibleParts parts(floor, {0, 0, 1}, x, kernel.R, hiders, shadow);
    for (Polygon p; parts.find_next(p);)
      sum += facet_integrals(x, p.corner.data(), p.count, {0, 0, 1}, kernel);
    EXPECT_TRUE(parts.complete());
    return sum;
  };
  const FacetIntegrals seen = seen_past(2);
  const Vec3d half[4] = {{0, -2, 0}, {2, -2, 0}, {2, 2, 0}, {0, 2, 0}};
  const FacetIntegrals expected = facet_integrals(x, half, 4, {0, 0, 1}, kernel);
  EXPECT_NEAR(seen.surface, expected.surface, 1e-8);
  EXPECT_NEAR(seen.shadow, expected.shadow, 1e-9);
  EXPECT_NEAR(seen_past(3).surface, expected.surface, 1e-8) << "a sheet behind the first hides nothing more";
}

// Floor and sheet of the triangles above: with the strips beyond its edges a facet acts as its whole plane.
TEST(CommonEdge, ContinuesTheFloorBehindTheSheet) {
  const WallKernel kernel = WallKernel::of(0.3, 0);
  const Vec3d x{0.07, 0, 0.1};
  const Triangle sheet{{{0, -4, 0}, {0, 4, 0}, {0, 0, 4}}, {1, 0, 0}},
      floor{{{-4, -9, 0}, {4, -9, 0}, {0, 9, 0}}, {0, 0, 1}};
  Vec3d strip[4];
  ASSERT_TRUE(strip_beyond(floor, sheet, x, 0.6, 1e-6, strip));
  const Vec3d seen[4] = {{0, -2, 0}, {2, -2, 0}, {2, 2, 0}, {0, 2, 0}};
  const FacetIntegrals whole = square(x, 2, kernel), part = facet_integrals(x, seen, 4, {0, 0, 1}, kernel);
  EXPECT_NEAR(part.surface + facet_integrals(x, strip, 4, {0, 0, 1}, kernel).surface, whole.surface, 1e-11);
  // Below its edge on the floor, the sheet continues.
  ASSERT_TRUE(strip_beyond(sheet, floor, x, 0.6, 1e-6, strip));
  for (const Vec3d corner : strip) EXPECT_LE(corner.z, 1e-12);
  // A sheet that ends above the floor, and one beside it.
  const Triangle above{{{0, -4, 0.1}, {0, 4, 0.1}, {0, 0, 4}}, {1, 0, 0}},
      beside{{{0, 4, 0}, {0, 8, 0}, {0, 6, 4}}, {1, 0, 0}};
  EXPECT_FALSE(strip_beyond(above, floor, x, 0.6, 0.05, strip));
  EXPECT_TRUE(strip_beyond(above, floor, x, 0.6, 0.15, strip));
  EXPECT_FALSE(strip_beyond(beside, floor, x, 0.6, 0.05, strip));
  // Two floors that end at the sheet: the one behind it is no wall of what is in front.
  const Triangle front{{{0, -9, 0}, {4, 0, 0}, {0, 9, 0}}, {0, 0, 1}},
      behind{{{-4, 0, 0}, {0, -9, 0}, {0, 9, 0}}, {0, 0, 1}};
  EXPECT_TRUE(strip_beyond(front, sheet, x, 0.6, 1e-6, strip));
  EXPECT_FALSE(strip_beyond(behind, sheet, x, 0.6, 1e-6, strip));
  EXPECT_FALSE(strip_beyond(sheet, behind, x, 0.6, 1e-6, strip) &&
               strip_beyond(sheet, front, x, 0.6, 1e-6, strip))
      << "the sheet continues below the floor once";
}

// Two triangles of one plane that join along a part of an edge.
TEST(CommonEdge, IsFoundWhereFacetsContinueEachOther) {
  const Triangle left{{{0, -2, 0}, {0, 2, 0}, {-3, 0, 0}}, {0, 0, 1}},
      right{{{0, 1, 0}, {0, -1, 0}, {3, 0, 0}}, {0, 0, 1}},
      apart{{{0.2, 1, 0}, {0.2, -1, 0}, {3, 0, 0}}, {0, 0, 1}},
      on_top{{{0, 1, 0}, {0, -1, 0}, {-2, 0, 0}}, {0, 0, 1}};
  const Vec3d x{-0.1, 0, 0.1};
  Vec3d strip[4], outward;
  ASSERT_TRUE(strip_between(left, right, x, 5, 0.01, strip, outward));
  EXPECT_NEAR(norm(outward - Vec3d{1, 0, 0}), 0, 1e-15);
  for (const Vec3d corner : strip) {
    EXPECT_NEAR(corner.x, 0, 1e-15);
    EXPECT_NEAR(std::fabs(corner.y), 1, 1e-15);
    EXPECT_LE(corner.z, 0) << "behind the facets";
  }
  EXPECT_FALSE(strip_between(left, apart, x, 5, 0.01, strip, outward));
  EXPECT_FALSE(strip_between(left, on_top, x, 5, 0.01, strip, outward));
}

// The integral over the shadow of (y - x) (y - x)^T times -(dW/dr)/r is symmetric and has positive
// eigenvalues; by the divergence theorem it is B I - n Y^T - D. Here a triangle with three free edges.
TEST(FacetIntegrals, WithTheSidesOfTheShadowAreThoseOfASymmetricTensor) {
  const WallKernel kernel = WallKernel::of(0.3, 0.1);
  const Vec3d corner[3] = {{-0.1, -0.05, 0}, {0.15, -0.1, 0}, {0.02, 0.2, 0}}, x{0.03, 0.01, 0.06};
  const FacetIntegrals f = facet_integrals(x, corner, 3, {0, 0, 1}, kernel);
  Mat3d tensor;
  const Vec3d n{0, 0, 1};
  for (int a = 0; a < 3; ++a) {
    tensor.row[a] = -1.0 * (n[a] * f.moment + f.sides.row[a]);
    tensor.row[a][a] += f.shadow;
  }
  for (int a = 0; a < 3; ++a) {
    EXPECT_GT(tensor.row[a][a], 0);
    for (int b = 0; b < a; ++b) EXPECT_NEAR(tensor.row[a][b], tensor.row[b][a], 1e-13) << a << b;
  }
}

}  // namespace
}  // namespace tandem::test
