#include "sph_server/io/patches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tandem::sph {
namespace {

using Polygon = std::vector<Vec3d>;

void append_fan(const Polygon& polygon, std::size_t source, TriangleMesh& to,
                std::vector<std::size_t>& sources) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), polygon.begin(), polygon.end());
  for (std::uint32_t k = 2; k < polygon.size(); ++k) {
    to.triangles.push_back({first, first + k - 1, first + k});
    sources.push_back(source);
  }
}

// The parts of a convex polygon on both sides of the plane at `at` along an axis of its frame. Corners that
// are nearer to the plane than `tolerance` are in it: rounding leaves no slivers.
std::pair<Polygon, Polygon> split(const Polygon& polygon, int axis, double at, double tolerance) {
  Polygon below, above;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3d a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    const double from = a[axis] - at, to = b[axis] - at;
    if (from <= tolerance) below.push_back(a);
    if (from >= -tolerance) above.push_back(a);
    if ((from < -tolerance && to > tolerance) || (from > tolerance && to < -tolerance)) {
      const Vec3d cut = a + from / (from - to) * (b - a);
      below.push_back(cut);
      above.push_back(cut);
    }
  }
  // Only corners in the plane: nothing is on that side.
  const auto reaches = [&](const Polygon& part) {
    return part.size() > 2 &&
           std::ranges::any_of(part, [&](Vec3d x) { return std::fabs(x[axis] - at) > tolerance; });
  };
  if (!reaches(below)) below.clear();
  if (!reaches(above)) above.clear();
  return {below, above};
}

}  // namespace

CutMesh cut_by_box(const TriangleMesh& mesh, const Pose& pose, Vec3d size) {
  const Mat3d axes = pose.q_WB.matrix();
  const double tolerance = 1e-9 * std::max({size.x, size.y, size.z});
  CutMesh cut;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Polygon rest;
    for (const std::uint32_t corner : mesh.triangles[t])
      rest.push_back(axes.transpose_times(mesh.vertices[corner] - pose.p_WB));
    std::vector<Polygon> outside;
    for (int axis = 0; axis < 3 && !rest.empty(); ++axis)
      for (const double side : {-0.5, 0.5}) {
        auto [below, above] = split(rest, axis, side * size[axis], tolerance);
        // A triangle within the plane of a face is inside.
        if (below.empty() && above.empty()) continue;
        outside.push_back(side < 0 ? below : above);
        rest = side < 0 ? above : below;
        if (outside.back().empty()) outside.pop_back();
        if (rest.empty()) break;
      }
    if (rest.empty()) {  // keep a triangle whole that is not in the box
      Polygon whole;
      for (const std::uint32_t corner : mesh.triangles[t]) whole.push_back(mesh.vertices[corner]);
      append_fan(whole, t, cut.outside, cut.outside_of);
      continue;
    }
    const auto back = [&](Polygon polygon) {
      for (Vec3d& x : polygon) x = pose.p_WB + axes * x;
      return polygon;
    };
    append_fan(back(rest), t, cut.inside, cut.inside_of);
    for (const Polygon& part : outside) append_fan(back(part), t, cut.outside, cut.outside_of);
  }
  return cut;
}

Vec3d patch_size(const scene::RectangleShape& area) {
  return {area.x, area.y, std::max(area.x, area.y)};
}

double area_along(const TriangleMesh& mesh, Vec3d axis) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += 0.5 * std::fabs(dot(axis, cross(mesh.vertices[t[1]] - mesh.vertices[t[0]],
                                           mesh.vertices[t[2]] - mesh.vertices[t[0]])));
  return sum;
}

}  // namespace tandem::sph
