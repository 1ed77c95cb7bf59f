#include "common/geometry/mass_properties.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/bounds.hpp"

namespace tandem {

namespace {

constexpr double pi = std::numbers::pi;

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix matrix_of(const std::array<double, 6>& s) {
  return {{{s[0], s[3], s[4]}, {s[3], s[1], s[5]}, {s[4], s[5], s[2]}}};
}
std::array<double, 6> upper(const Matrix& m) {
  return {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
}

// Adds weight (|d|^2 1 - d d^T), the inertia of a point mass.
void add_point(std::array<double, 6>& inertia, double weight, Vec3d d) {
  inertia[0] += weight * (d.y * d.y + d.z * d.z);
  inertia[1] += weight * (d.x * d.x + d.z * d.z);
  inertia[2] += weight * (d.x * d.x + d.y * d.y);
  inertia[3] -= weight * d.x * d.y;
  inertia[4] -= weight * d.x * d.z;
  inertia[5] -= weight * d.y * d.z;
}

double volume_about(const TriangleMesh& mesh, Vec3d reference) {
  double six = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    six +=
        dot(mesh.vertices[i] - reference, cross(mesh.vertices[j] - reference, mesh.vertices[k] - reference));
  return six / 6;
}

}  // namespace

MassProperties mass_of_box(Vec3d s, double density) {
  const double m = density * s.x * s.y * s.z;
  return {m,
          {},
          {m / 12 * (s.y * s.y + s.z * s.z), m / 12 * (s.x * s.x + s.z * s.z),
           m / 12 * (s.x * s.x + s.y * s.y), 0, 0, 0}};
}

MassProperties mass_of_sphere(double radius, double density) {
  const double m = density * 4 * pi / 3 * radius * radius * radius, I = 0.4 * m * radius * radius;
  return {m, {}, {I, I, I, 0, 0, 0}};
}

MassProperties mass_of_cylinder(double radius, double height, double density) {
  const double r2 = radius * radius, m = density * pi * r2 * height;
  const double across = m * (r2 / 4 + height * height / 12);
  return {m, {}, {across, across, m * r2 / 2, 0, 0, 0}};
}

// A hemisphere has its centre of mass 3/8 of the radius above its base.
MassProperties mass_of_capsule(double radius, double height, double density) {
  const MassProperties cylinder = mass_of_cylinder(radius, height, density),
                       sphere = mass_of_sphere(radius, density);
  const double across =
      cylinder.inertia[0] + sphere.inertia[0] + sphere.mass * (height * height / 4 + 3 * height * radius / 8);
  return {
      cylinder.mass + sphere.mass, {}, {across, across, cylinder.inertia[2] + sphere.inertia[2], 0, 0, 0}};
}

// Integrals over t = 0 .. 1 of powers of the radius R + (r - R) t, times powers of t.
MassProperties mass_of_cone(double radius, double top_radius, double height, double density) {
  const double R = radius, r = top_radius, h = height;
  const double a2 = (R * R + R * r + r * r) / 3, ta2 = (R * R + 2 * R * r + 3 * r * r) / 12,
               t2a2 = (R * R + 3 * R * r + 6 * r * r) / 30,
               a4 = (R * R * R * R + R * R * R * r + R * R * r * r + R * r * r * r + r * r * r * r) / 5;
  const double m = density * pi * h * a2, centre = h * ta2 / a2;  // above the lower end
  const double across = density * pi * h * (a4 / 4 + h * h * t2a2) - m * centre * centre;
  return {m, {0, 0, centre - h / 2}, {across, across, density * pi * h * a4 / 2, 0, 0, 0}};
}

MassProperties mass_of_mesh(const TriangleMesh& mesh, double density) {
  const Vec3d reference = bounds_of(mesh.vertices).middle();
  double volume = 0;               // times 6
  Vec3d first;                     // moment, times 24
  std::array<double, 6> second{};  // moments xx yy zz xy xz yz, times 120
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d a = mesh.vertices[i] - reference, b = mesh.vertices[j] - reference,
                c = mesh.vertices[k] - reference, s = a + b + c;
    const double v = dot(a, cross(b, c));
    volume += v;
    first += v * s;
    constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (std::size_t n = 0; n < 6; ++n) {
      const auto [p, q] = pairs[n];
      second[n] += v * (s[p] * s[q] + a[p] * a[q] + b[p] * b[q] + c[p] * c[q]);
    }
  }
  // Clockwise winding changes the sign of every sum.
  const double factor = volume < 0 ? -density : density;
  MassProperties solid;
  solid.mass = factor * volume / 6;
  const Vec3d centre = 1 / (4 * volume) * first;  // from the reference
  solid.centre = reference + centre;
  std::array<double, 6> moments{};  // about the centre of mass
  for (std::size_t n = 0; n < 6; ++n) moments[n] = factor * second[n] / 120;
  solid.inertia = {moments[1] + moments[2],
                   moments[0] + moments[2],
                   moments[0] + moments[1],
                   -moments[3],
                   -moments[4],
                   -moments[5]};
  add_point(solid.inertia, -solid.mass, centre);
  return solid;
}

double signed_volume(const TriangleMesh& mesh) {
  return volume_about(mesh, bounds_of(mesh.vertices).middle());
}

double winding_number(const TriangleMesh& mesh, Vec3d point) {
  return winding_number(mesh, mesh.vertices, point);
}

double winding_number(const TriangleMesh& mesh, const std::vector<Vec3d>& vertices, Vec3d point) {
  double angle = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d a = vertices[i] - point, b = vertices[j] - point, c = vertices[k] - point;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    angle +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * pi);
}

MassProperties placed(const MassProperties& solid, const Pose& pose) {
  const Mat3d R = pose.q_WB.matrix();
  const Matrix I = matrix_of(solid.inertia);
  Matrix turned{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) turned[i][j] += R.row[i][k] * I[k][l] * R.row[j][l];
  return {solid.mass, pose.p_WB + pose.q_WB.rotate(solid.centre), upper(turned)};
}

MassProperties sum(const std::vector<MassProperties>& solids) {
  MassProperties all;
  if (solids.empty()) return all;
  // Relative to one of the centres, so that distances and not positions are weighted.
  const Vec3d reference = solids.front().centre;
  Vec3d moment;
  for (const MassProperties& solid : solids) {
    all.mass += solid.mass;
    moment += solid.mass * (solid.centre - reference);
  }
  all.centre = all.mass > 0 ? reference + (1 / all.mass) * moment : reference;
  for (const MassProperties& solid : solids) {
    for (std::size_t n = 0; n < 6; ++n) all.inertia[n] += solid.inertia[n];
    add_point(all.inertia, solid.mass, (solid.centre - reference) - (all.centre - reference));
  }
  return all;
}

}  // namespace tandem
