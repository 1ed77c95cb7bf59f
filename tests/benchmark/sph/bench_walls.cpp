// CPU time of what particles see of the walls near them:
//   bench_walls [SAMPLES]
// For each mesh, as given and coarsened to 0.05 spacings, it takes points from 0.3 to 3 spacings off the
// facets given, and prints the time per point and step, its worst hundredth, how many facets the support has
// that are not dropped, and how far the pressure of the walls differs from that of the mesh as given.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/geometry/coarse_mesh.hpp"
#include "particles/geometry/touch_facet.hpp"
#include "sph_server/kernel/seen_integrals.hpp"
#include "sph_server/neighbours/walls.hpp"
#include "tests/benchmark/sph/drum_mesh.hpp"

namespace {

using namespace tandem;
using benchmark::add_quad;
using benchmark::add_triangle;
using benchmark::drum;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

// A sphere of 20 n^2 triangles with bumps: rough, as a block of cast iron.
TriangleMesh rough_block(double radius, double height, int n) {
  const double p = (1 + std::sqrt(5.0)) / 2;
  const Vec3d v[12] = {{-1, p, 0},  {1, p, 0},  {-1, -p, 0}, {1, -p, 0}, {0, -1, p},  {0, 1, p},
                       {0, -1, -p}, {0, 1, -p}, {p, 0, -1},  {p, 0, 1},  {-p, 0, -1}, {-p, 0, 1}};
  constexpr int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const auto bumped = [&](Vec3d d) {
    d = normalized(d);
    const double bump = std::sin(9 * d.x + 0.3) * std::sin(9 * d.y + 0.7) * std::sin(9 * d.z + 1.1);
    return (radius + height * bump) * d;
  };
  TriangleMesh m;
  for (const auto& f : faces) {
    const auto at = [&](int i, int j) { return bumped((n - i - j) * v[f[0]] + i * v[f[1]] + j * v[f[2]]); };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add_triangle(m, at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < n) add_triangle(m, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return m;
}

double distance_to(Vec3d x, const sph::NearWalls& near, double R) {
  double least = R;
  for (int k = 0; k < near.count; ++k) {
    const sph::NearFacet& f = near.facet[k];
    particles::WallContact contact;
    if (particles::touch_triangle(particles::Facet{f.a, f.b, f.c, f.normal}, x, R, contact))
      least = std::min(least, contact.gap + R);
  }
  return least;
}

// Returns the sum of S n at each point, times the spacing.
std::vector<Vec3d> time_of(const char* name, const char* which, const sph::Walls& walls,
                           const std::vector<Vec3d>& points, double spacing, double built,
                           const std::vector<Vec3d>& exact) {
  const double R = 3 * spacing;
  const sph::WallKernel kernel = sph::WallKernel::of(R, spacing);
  sph::NearWalls near;
  std::vector<double> times;
  std::vector<Vec3d> all;
  double facets = 0;
  for (const Vec3d& x : points) {
    // Several times, since the clock is coarse.
    int repeats = 0;
    const double start = cpu_seconds();
    double passed = 0;
    Vec3d sum;
    do {
      sum = {};
      walls.find_seen(x, R, near);
      bool complete = true;
      for (int k = 0; k < near.count; ++k) {
        const sph::NearFacet& f = near.facet[static_cast<std::size_t>(k)];
        sum += (f.height < 0 ? -spacing : spacing) *
               sph::seen_integrals(x, near, k, kernel, complete).surface * f.normal;
      }
      ++repeats;
      passed = cpu_seconds() - start;
    } while (passed < 2e-4);
    times.push_back(1e6 * passed / repeats);
    facets += near.count;
    all.push_back(sum);
  }
  std::sort(times.begin(), times.end());
  double mean = 0;
  for (const double t : times) mean += t / static_cast<double>(times.size());
  double squares = 0, largest = 0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    squares += norm2(all[k] - exact[k]) / static_cast<double>(exact.size());
    largest = std::max(largest, norm(all[k] - exact[k]));
  }
  std::printf(
      "%-23s %-9s %7zu triangles, %5.1f in sight, mean %7.2f us, worst hundredth %7.2f us, built in %.2f s, "
      "differs by %.4f, at most %.4f\n",
      name, which, walls.facets().size(), facets / static_cast<double>(points.size()), mean,
      times[static_cast<std::size_t>(0.99 * static_cast<double>(times.size()))], built, std::sqrt(squares),
      largest);
  std::fflush(stdout);
  return all;
}

// side: of the normals on which the points are; 0: both.
void measure(const char* name, const TriangleMesh& mesh, double spacing, int side, int samples) {
  const double R = 3 * spacing;
  const double begin = cpu_seconds();
  const sph::Walls walls({mesh}, R);
  const double built = cpu_seconds() - begin;
  std::mt19937_64 bits(7);
  const auto random = [&bits] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  std::vector<Vec3d> points;
  sph::NearWalls near;
  for (int tries = 0; static_cast<int>(points.size()) < samples && tries < 100 * samples; ++tries) {
    const auto& f =
        walls.facets()[static_cast<std::size_t>(random() * static_cast<double>(walls.facets().size()))];
    double a = random(), b = random();
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const double sign = side != 0 ? side : random() < 0.5 ? -1 : 1;
    const Vec3d x =
        f.a + a * (f.b - f.a) + b * (f.c - f.a) + (sign * (0.3 + 2.7 * random()) * spacing) * f.normal;
    walls.find(x, R, near);
    if (distance_to(x, near, R) < 0.3 * spacing) continue;
    points.push_back(x);
  }
  const std::vector<Vec3d> exact = time_of(name, "as given", walls, points, spacing, built, {});
  const double start = cpu_seconds();
  const CoarseMesh coarse = coarsened(mesh, 0.05 * spacing);
  const sph::Walls coarse_walls({coarse.mesh}, R);
  time_of(name, "coarsened", coarse_walls, points, spacing, cpu_seconds() - start, exact);
}

}  // namespace

int main(int argc, char** argv) {
  const int samples = argc > 1 ? std::atoi(argv[1]) : 400;
  TriangleMesh flat;
  add_quad(flat, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  measure("flat wall", flat, 0.02, 1, samples);
  measure("round tank, 52 segments", cylinder_mesh(0.1, 0.2, 52), 0.02, -1, samples);
  measure("round tank, 24 segments", cylinder_mesh(0.1, 0.2, 24), 0.02, -1, samples);
  measure("drum, sheet", drum(0.25, 72, 18, 0.0025, 0), 0.002, 0, samples);
  measure("drum, 0.6 mm thick", drum(0.25, 72, 18, 0.0025, 0.0006), 0.002, 1, samples);
  measure("rough block", rough_block(0.2, 0.01, 40), 0.004, 1, samples);
  measure("rough block, fine", rough_block(0.2, 0.01, 80), 0.004, 1, samples);
}
