// Mass, centre and inertia of solids against closed forms that are written here a second time, by another
// route: as sums of integrals, or as the same solid made of triangles.
#include "common/geometry/mass_properties.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "common/geometry/convex_hull.hpp"
#include "common/geometry/solid_mesh.hpp"

namespace tandem {
namespace {

constexpr double pi = std::numbers::pi;

// The deviation of mass and inertia relative to them, and of the centre relative to the size of the solid.
double deviation(const MassProperties& measured, const MassProperties& expected) {
  const double moment = std::max({expected.inertia[0], expected.inertia[1], expected.inertia[2]});
  const double size = std::sqrt(moment / expected.mass);
  double worst = std::abs(measured.mass / expected.mass - 1);
  for (std::size_t i = 0; i < 6; ++i)
    worst = std::max(worst, std::abs(measured.inertia[i] - expected.inertia[i]) / moment);
  return std::max(worst, norm(measured.centre - expected.centre) / size);
}

void expect_row(const char* what, const MassProperties& measured, const MassProperties& expected,
                double tolerance) {
  const double found = deviation(measured, expected);
  std::printf("%-46s mass %.15g, expected %.15g; deviation %.1e, tolerance %.0e\n", what, measured.mass,
              expected.mass, found, tolerance);
  EXPECT_LE(found, tolerance) << what;
}

// Gauss-Legendre integral with 8 points, exact for polynomials up to degree 15.
template <class F>
double integral(const F& f, double from, double to) {
  constexpr double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  const double middle = (from + to) / 2, half = (to - from) / 2;
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += w[i] * (f(middle - half * x[i]) + f(middle + half * x[i]));
  return half * sum;
}

// A solid of revolution whose squared radius is a polynomial, by discs.
struct Part {
  double from, to;
  double (*radius2)(double);
};
MassProperties of_discs(std::initializer_list<Part> parts, double density) {
  double m = 0, mz = 0, axial = 0, across = 0;
  for (const Part& part : parts) {
    const auto area = [&](double z) { return density * pi * part.radius2(z); };
    m += integral(area, part.from, part.to);
    mz += integral([&](double z) { return z * area(z); }, part.from, part.to);
    axial += integral([&](double z) { return area(z) * part.radius2(z) / 2; }, part.from, part.to);
    across += integral([&](double z) { return area(z) * (part.radius2(z) / 4 + z * z); }, part.from, part.to);
  }
  across -= mz * mz / m;
  return {m, {0, 0, mz / m}, {across, across, axial, 0, 0, 0}};
}

TEST(MassProperties, ClosedFormsAgainstIntegralsOverDiscs) {
  constexpr double tight = 1e-12;
  expect_row("sphere, radius 0.3", mass_of_sphere(0.3, 7850),
             of_discs({{-0.3, 0.3, [](double z) { return 0.09 - z * z; }}}, 7850), tight);
  expect_row("cylinder, radius 0.2, height 0.7", mass_of_cylinder(0.2, 0.7, 2700),
             of_discs({{-0.35, 0.35, [](double) { return 0.04; }}}, 2700), tight);
  expect_row("capsule, radius 0.2, height 0.7", mass_of_capsule(0.2, 0.7, 1200),
             of_discs({{-0.55, -0.35, [](double z) { return 0.04 - (z + 0.35) * (z + 0.35); }},
                       {-0.35, 0.35, [](double) { return 0.04; }},
                       {0.35, 0.55, [](double z) { return 0.04 - (z - 0.35) * (z - 0.35); }}},
                      1200),
             tight);
  expect_row("cone, radius 0.4, height 0.5", mass_of_cone(0.4, 0, 0.5, 1000),
             of_discs({{-0.25, 0.25,
                        [](double z) {
                          const double a = 0.4 * (0.25 - z) / 0.5;
                          return a * a;
                        }}},
                      1000),
             tight);
  expect_row("truncated cone, radii 0.4 and 0.1", mass_of_cone(0.4, 0.1, 0.5, 1000),
             of_discs({{-0.25, 0.25,
                        [](double z) {
                          const double a = 0.4 - 0.3 * (z + 0.25) / 0.5;
                          return a * a;
                        }}},
                      1000),
             tight);
  expect_row("box, 0.3 x 0.5 x 0.7", mass_of_box({0.3, 0.5, 0.7}, 1000),
             {105, {}, {105.0 / 12 * 0.74, 105.0 / 12 * 0.58, 105.0 / 12 * 0.34, 0, 0, 0}}, tight);
}

// Rigid motions: at the origin, and a thousand times the size of the solid away.
std::vector<Pose> poses() {
  std::mt19937_64 random(20261125);
  std::normal_distribution<double> normal;
  std::vector<Pose> all{{}};
  for (const double distance : {0.0, 1.0, 1e3, 1e3})
    all.push_back({distance * normalized(Vec3d{normal(random), normal(random), normal(random)}),
                   Quat{normal(random), normal(random), normal(random), normal(random)}.normalized()});
  return all;
}

struct Case {
  const char* what;
  TriangleMesh mesh;
  MassProperties expected;
  double tolerance;
};

// The exact values of the polyhedron itself: apart from rounding, no discretisation enters.
TEST(MassProperties, MeshesUnderRigidMotions) {
  const std::vector<std::vector<double>> slope{{0.1, 0.3}, {0.1, 0.3}},
      flat{{0.2, 0.2, 0.2}, {0.2, 0.2, 0.2}};
  std::vector<Vec3d> corners = box_mesh({0.3, 0.5, 0.7}).vertices;
  corners.push_back({0, 0, 0});          // inside
  corners.push_back({0.15, 0, 0});       // in a face
  corners.push_back({0.15, 0.25, 0.1});  // in an edge
  const MassProperties box = mass_of_box({0.3, 0.5, 0.7}, 1000);
  // A prism with n corners at radius r: area n r^2 sin(2 pi / n) / 2, polar moment of the area
  // area r^2 (2 + cos(2 pi / n)) / 6.
  const double n = 12, r = 0.2, h = 0.7, area = n * r * r * std::sin(2 * pi / n) / 2,
               polar = area * r * r * (2 + std::cos(2 * pi / n)) / 6, m = 1000 * area * h;
  const double across = 1000 * h * polar / 2 + m * h * h / 12;
  // A wedge: the box below the slope, plus a triangular prism.
  const MassProperties plate = placed(mass_of_box({1, 1, 0.1}, 1000), {{0, 0, 0.05}, {}});
  const double base = 1, height = 0.2, wedge = 1000 * base * height / 2;  // right triangle, depth 1
  const MassProperties prism{
      wedge,
      {-0.5 + 2.0 / 3, 0, 0.1 + height / 3},
      {wedge * (1.0 / 12 + height * height / 18), wedge * (base * base + height * height) / 18,
       wedge * (1.0 / 12 + base * base / 18), 0, -wedge * base * height / 36, 0}};
  const Case cases[] = {
      {"box mesh", box_mesh({0.3, 0.5, 0.7}), box, 1e-10},
      {"hull of a box with points inside", *convex_hull(corners), box, 1e-10},
      {"prism of 12 faces",
       cylinder_mesh(r, h, 12),
       {m, {}, {across, across, 1000 * h * polar, 0, 0, 0}},
       1e-10},
      {"height field, flat", height_field_mesh(0.3, 0.5, flat, -0.5), placed(box, {{0, 0, -0.15}, {}}),
       1e-10},
      {"height field, a slope", height_field_mesh(1, 1, slope, 0.0), sum({plate, prism}), 1e-10},
  };
  for (const Case& c : cases)
    for (const Pose& pose : poses()) {
      TriangleMesh moved = transformed(c.mesh, pose);
      const std::string what =
          std::string(c.what) + ", " + std::to_string(static_cast<int>(norm(pose.p_WB))) + " m away";
      expect_row(what.c_str(), mass_of_mesh(moved, 1000), placed(c.expected, pose), c.tolerance);
      for (auto& t : moved.triangles) std::swap(t[0], t[1]);
      EXPECT_LE(deviation(mass_of_mesh(moved, 1000), placed(c.expected, pose)), c.tolerance) << c.what;
    }
}

// Inscribed meshes approach the round solid with the square of the angle of their segments.
TEST(MassProperties, RoundMeshesConverge) {
  struct Round {
    const char* what;
    TriangleMesh (*mesh)(int segments);
    MassProperties expected;
  };
  const Round rounds[] = {
      {"sphere", [](int n) { return sphere_mesh(0.3, n); }, mass_of_sphere(0.3, 1000)},
      {"capsule", [](int n) { return capsule_mesh(0.2, 0.7, n); }, mass_of_capsule(0.2, 0.7, 1000)},
      {"cone", [](int n) { return cone_mesh(0.4, 0, 0.5, n); }, mass_of_cone(0.4, 0, 0.5, 1000)},
      {"truncated cone", [](int n) { return cone_mesh(0.4, 0.1, 0.5, n); },
       mass_of_cone(0.4, 0.1, 0.5, 1000)},
  };
  for (const Round& round : rounds) {
    ASSERT_EQ(why_not_solid(round.mesh(64)), "") << round.what;
    const double coarse = deviation(mass_of_mesh(round.mesh(64), 1000), round.expected),
                 fine = deviation(mass_of_mesh(round.mesh(256), 1000), round.expected);
    std::printf("%-16s deviation %.2e with 64 segments, %.2e with 256; ratio %.2f, expected 16\n", round.what,
                coarse, fine, coarse / fine);
    EXPECT_NEAR(coarse / fine, 16, 0.5) << round.what;
  }
}

// A fine sphere of triangles, against its own polyhedron: the sum of its pyramids to the centre, in closed
// form.
TEST(MassProperties, FineSphereAgainstItsOwnPolyhedron) {
  const TriangleMesh sphere = sphere_mesh(0.3, 512);
  long double volume = 0, xx = 0, yy = 0, zz = 0;
  for (const auto& [i, j, k] : sphere.triangles) {
    const Vec3d a = sphere.vertices[i], b = sphere.vertices[j], c = sphere.vertices[k];
    const long double v = dot(a, cross(b, c));
    volume += v / 6;
    const auto square = [&](int q) {
      return v / 60 * (a[q] * a[q] + b[q] * b[q] + c[q] * c[q] + a[q] * b[q] + b[q] * c[q] + c[q] * a[q]);
    };
    xx += square(0);
    yy += square(1);
    zz += square(2);
  }
  const auto d = [](long double value) { return static_cast<double>(1000 * value); };
  const MassProperties exact{d(volume), {}, {d(yy + zz), d(xx + zz), d(xx + yy), 0, 0, 0}};
  for (const Pose& pose : poses())
    expect_row("sphere of 261,120 triangles", mass_of_mesh(transformed(sphere, pose), 1000),
               placed(exact, pose), 1e-6);
}

// Solids that are cut apart and put together again, far from the origin, are the whole.
TEST(MassProperties, SumsOfParts) {
  const MassProperties half = mass_of_box({0.15, 0.5, 0.7}, 1000), whole = mass_of_box({0.3, 0.5, 0.7}, 1000);
  for (const Pose& pose : poses()) {
    const auto at = [&](double x) {
      return placed(half, {pose.p_WB + pose.q_WB.rotate({x, 0, 0}), pose.q_WB});
    };
    expect_row("two halves of a box", sum({at(-0.075), at(0.075)}), placed(whole, pose),
               norm(pose.p_WB) > 10 ? 1e-11 : 1e-12);
  }
}

}  // namespace
}  // namespace tandem
