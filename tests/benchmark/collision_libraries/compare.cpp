// Contacts of simple pairs by three collision libraries, against closed forms.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>

#include "library.hpp"

using namespace collision_libraries;

namespace {

constexpr double depth = 1e-3;

Isometry3d at(double x, double y, double z, const Vector3d& turn = Vector3d::Zero()) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  if (turn.norm() > 0) X.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return X;
}

Shape cube_of_triangles(Shape::Kind kind, double edge) {
  Shape s{.kind = kind};
  for (int i = 0; i < 8; ++i)
    s.vertices.push_back(0.5 * edge * Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  s.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return s;
}

Shape flat_mesh(int cells) {
  Shape s{.kind = Shape::mesh};
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) s.vertices.push_back({4. * i / cells - 2, 4. * j / cells - 2, 0});
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int v = j * (cells + 1) + i;
      s.triangles.push_back({v, v + 1, v + cells + 1});
      s.triangles.push_back({v + 1, v + cells + 2, v + cells + 1});
    }
  return s;
}

struct Case {
  const char* name;
  Shape a, b;
  Isometry3d X_a, X_b;
  double depth;  // closed form; negative: separated
  Vector3d n;    // from b to a
};

std::vector<Case> cases() {
  const Shape cube{.kind = Shape::box, .size = Vector3d::Ones()}, ball{.kind = Shape::sphere, .radius = 0.5},
      plane{.kind = Shape::plane}, cylinder{.kind = Shape::cylinder, .radius = 0.5, .height = 1},
      capsule{.kind = Shape::capsule, .radius = 0.5, .height = 1},
      hull = cube_of_triangles(Shape::hull, 1), mesh = flat_mesh(7),
      cube_mesh = cube_of_triangles(Shape::mesh, 1),
      field{.kind = Shape::height_field, .size = Vector3d(4, 4, 0), .samples = 8},
      plate{.kind = Shape::box, .size = Vector3d(1, 1, 1e-4)}, pellet{.kind = Shape::sphere, .radius = 0.01};
  const Vector3d up = Vector3d::UnitZ();
  const double quarter = 0.7853981633974483, half_pi = 2 * quarter;
  // A cube on an edge across the edge of another: the edges cross at right angles.
  const Isometry3d edge_low = at(0, 0, 0, {quarter, 0, 0}),
                   edge_high = at(0.03, 0.02, std::sqrt(2.) - depth, {0, quarter, 0});
  return {
      {"box-box face", cube, cube, at(0.2, 0.1, 1 - depth), at(0, 0, 0), depth, up},
      {"box-box face, turned 30 deg", cube, cube, at(0, 0, 1 - depth, {0, 0, 0.5236}), at(0, 0, 0), depth,
       up},
      {"box-box crossed edges", cube, cube, edge_high, edge_low, depth, up},
      {"box on plane", cube, plane, at(0, 0, 0.5 - depth), at(0, 0, 0), depth, up},
      {"cylinder end on plane", cylinder, plane, at(0, 0, 0.5 - depth), at(0, 0, 0), depth, up},
      {"cylinder side on plane", cylinder, plane, at(0, 0, 0.5 - depth, {half_pi, 0, 0}), at(0, 0, 0), depth,
       up},
      {"cylinder side on box", cylinder, cube, at(0, 0, 1 - depth, {half_pi, 0, 0}), at(0, 0, 0), depth, up},
      {"capsule lying on box", capsule, cube, at(0, 0, 1 - depth, {half_pi, 0, 0}), at(0, 0, 0), depth, up},
      {"hull-hull face", hull, hull, at(0.2, 0.1, 1 - depth), at(0, 0, 0), depth, up},
      {"hull-hull crossed edges", hull, hull, edge_high, edge_low, depth, up},
      {"sphere-mesh, in a facet", ball, mesh, at(0.1, 0.2, 0.5 - depth), at(0, 0, 0), depth, up},
      {"sphere-mesh, on an edge", ball, mesh, at(0.2857142857142857, 0.2, 0.5 - depth), at(0, 0, 0), depth,
       up},
      {"capsule-mesh, lying", capsule, mesh, at(0.1, 0.2, 0.5 - depth, {half_pi, 0, 0}), at(0, 0, 0), depth,
       up},
      {"box-mesh face", cube, mesh, at(0.1, 0.2, 0.5 - depth), at(0, 0, 0), depth, up},
      {"mesh-mesh face", cube_mesh, mesh, at(0.1, 0.2, 0.5 - depth), at(0, 0, 0), depth, up},
      {"sphere-height field", ball, field, at(0.1, 0.2, 0.5 - depth), at(0, 0, 0), depth, up},
      {"pellet in plate of 0.1 mm", pellet, plate, at(0, 0, 0.01 + 0.5e-4 - 1e-5), at(0, 0, 0), 1e-5, up},
      {"pellet past middle of plate", pellet, plate, at(0, 0, 0.01 - 1e-5), at(0, 0, 0), 6e-5, up},
      {"sphere-sphere apart", ball, ball, at(0, 0, 1.1), at(0, 0, 0), -0.1, up},
      {"box-box face apart", cube, cube, at(0.2, 0.1, 1.1), at(0, 0, 0), -0.1, up},
      {"box-box corner apart", cube, cube, at(1.1, 1.1, 1.1), at(0, 0, 0), -std::sqrt(0.03),
       Vector3d(1, 1, 1).normalized()},
      {"hull-hull apart", hull, hull, at(0.2, 0.1, 1.1), at(0, 0, 0), -0.1, up},
      {"box-plane apart", cube, plane, at(0, 0, 0.6), at(0, 0, 0), -0.1, up},
      {"cylinder-box apart", cylinder, cube, at(0, 0, 1.1, {half_pi, 0, 0}), at(0, 0, 0), -0.1, up},
      {"sphere-mesh apart", ball, mesh, at(0.1, 0.2, 0.6), at(0, 0, 0), -0.1, up},
  };
}

void add(std::uint64_t& sum, double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  sum = (sum ^ bits) * 0x100000001b3u;
}

// Hash of the points of random overlapping pairs; `others` pairs are computed before each.
std::uint64_t hash_of(Library& library, const Shape& a, const Shape& b, int others) {
  auto ga = library.make(a), gb = library.make(b);
  std::uint64_t sum = 0xcbf29ce484222325u;
  std::mt19937_64 random(7), noise(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto pose = [&](auto& source) {
    return at(0.4 * unit(source), 0.4 * unit(source), 0.9 + 0.1 * unit(source),
              Vector3d(unit(source), unit(source), unit(source)));
  };
  for (int i = 0; i < 500; ++i) {
    const Isometry3d X = pose(random);
    for (int k = 0; k < others; ++k) library.collide(*ga, pose(noise), *gb, at(0, 0, 0));
    for (const Point& p : library.collide(*ga, X, *gb, at(0, 0, 0))) {
      for (const double v : {p.p.x(), p.p.y(), p.p.z(), p.depth}) add(sum, v);
    }
  }
  return sum;
}

// A cube turned about an axis in the plane of contact by small angles: how the number of points and the
// largest depth vary, and how far the points' mean moves from angle to angle.
void smoothness(Library& library, Shape::Kind kind) {
  const Shape s =
      kind == Shape::box ? Shape{.kind = Shape::box, .size = Vector3d::Ones()} : cube_of_triangles(kind, 1);
  auto a = library.make(s), b = library.make(s);
  int fewest = 99, most = 0, changes = 0, last = -1;
  double jump = 0, depth_error = 0;
  Vector3d before = Vector3d::Zero();
  for (int i = -200; i <= 200; ++i) {
    const double angle = 1e-5 * i;
    const Vector3d axis = Vector3d(1, 0.3, 0).normalized();
    const auto points = library.collide(*a, at(0.2, 0.1, 1 - depth, angle * axis), *b, at(0, 0, 0));
    double deepest = 0;
    Vector3d mean = Vector3d::Zero();
    for (const Point& p : points) deepest = std::max(deepest, p.depth), mean += p.p / points.size();
    const int n = int(points.size());
    if (last >= 0 && n != last) ++changes;
    // The forces' resultant of a linear law: the depth-weighted mean.
    Vector3d centre = Vector3d::Zero();
    double sum = 0;
    for (const Point& p : points) centre += p.depth * p.p, sum += p.depth;
    if (sum > 0) centre /= sum;
    if (last >= 0) jump = std::max(jump, (centre - before).norm());
    before = centre;
    // Deepest corner of the overlap of the faces, seen along z: corners (-0.3, -0.4) to (0.5, 0.5) of the
    // lower face.
    double exact = 0;
    const Isometry3d X = at(0.2, 0.1, 1 - depth, angle * axis);
    const Vector3d n_face = -X.linear().col(2), c = X * Vector3d(0, 0, -0.5);
    for (const double x : {-0.3, 0.5})
      for (const double y : {-0.4, 0.5})
        exact = std::max(exact,
                         0.5 - (c.z() - (n_face.x() * (x - c.x()) + n_face.y() * (y - c.y())) / n_face.z()));
    depth_error = std::max(depth_error, std::abs(deepest - exact));
    last = n, fewest = std::min(fewest, n), most = std::max(most, n);
  }
  std::printf(
      "  turned %s: %d to %d points, %d changes of the number, largest jump of the centre of force %.2g m, "
      "error of the largest depth %.2g m\n",
      kind == Shape::box ? "box" : "hull", fewest, most, changes, jump, depth_error);
}

void compare(Library& library) {
  std::printf("%s\n  %-32s %6s %12s %12s %10s %8s\n", library.name().c_str(), "case", "points", "depth error",
              "normal error", "swapped", "us");
  for (const Case& c : cases()) {
    auto a = library.make(c.a), b = library.make(c.b);
    if (!a || !b) {
      std::printf("  %-32s not tried\n", c.name);
      continue;
    }
    if (c.depth < 0) {
      const auto d = library.distance(*a, c.X_a, *b, c.X_b);
      if (!d)
        std::printf("  %-32s no distance\n", c.name);
      else
        std::printf("  %-32s %6s %12.2g\n", c.name, "-", *d + c.depth);
      continue;
    }
    const auto points = library.collide(*a, c.X_a, *b, c.X_b);
    double e = 0, n = 0;
    for (const Point& p : points)
      e = std::max(e, std::abs(p.depth - c.depth)), n = std::max(n, (p.n - c.n).norm());
    auto swapped = library.collide(*b, c.X_b, *a, c.X_a);
    double s = points.size() == swapped.size() ? 0 : HUGE_VAL;
    for (const Point& p : points) {
      double nearest = HUGE_VAL;
      for (const Point& o : swapped)
        nearest = std::min(nearest, (o.p - p.p).norm() + std::abs(o.depth - p.depth));
      s = std::max(s, nearest);
    }
    const int repeats = 2000;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) library.collide(*a, c.X_a, *b, c.X_b);
    const double us =
        1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / repeats;
    if (points.empty())
      std::printf("  %-32s %6d\n", c.name, 0);
    else
      std::printf("  %-32s %6zu %12.2g %12.2g %10.2g %8.2f\n", c.name, points.size(), e, n, s, us);
  }
  const Shape cube{.kind = Shape::box, .size = Vector3d::Ones()},
      hull = cube_of_triangles(Shape::hull, 1), cylinder{.kind = Shape::cylinder, .radius = 0.5, .height = 1};
  const std::pair<const char*, Shape> kinds[] = {{"box", cube}, {"hull", hull}, {"cylinder", cylinder}};
  for (const auto& [name, shape] : kinds)
    std::printf("  random %s-box pairs: hash %016llx, after other pairs %016llx\n", name,
                (unsigned long long)hash_of(library, shape, cube, 0),
                (unsigned long long)hash_of(library, shape, cube, 2));
  smoothness(library, Shape::box);
  smoothness(library, Shape::hull);
}

}  // namespace

int main(int count, char** arguments) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::string which = count == 2 ? arguments[1] : "";
  if (which == "bullet")
    compare(*make_bullet());
  else if (which == "ode")
    compare(*make_ode());
  else if (which == "fcl")
    compare(*make_fcl());
  else
    return std::fputs("usage: compare bullet|ode|fcl\n", stderr), 2;
}
