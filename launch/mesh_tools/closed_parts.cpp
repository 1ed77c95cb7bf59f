#include "launch/mesh_tools/closed_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "common/geometry/mass_properties.hpp"

namespace tandem::launch {
namespace closed_parts {

struct Part {
  TriangleMesh mesh;
  Vec3d low, high;  // bounds [m]
  bool is_closed = false;
  double volume = 0;                // of a closed part; negative where it winds inwards [m3]
  std::vector<std::size_t> around;  // closed parts that contain it
};

// Vertices are numbered anew in each part.
std::vector<Part> parts_of(const TriangleMesh& mesh, const std::vector<std::size_t>& part) {
  std::vector<Part> parts(part.empty() ? 0 : 1 + *std::ranges::max_element(part));
  std::vector<std::unordered_map<std::uint32_t, std::uint32_t>> number(parts.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh& own = parts[part[t]].mesh;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const auto [at, is_new] =
          number[part[t]].try_emplace(v, static_cast<std::uint32_t>(own.vertices.size()));
      if (is_new) own.vertices.push_back(mesh.vertices[v]);
      corners[k] = at->second;
    }
    own.triangles.push_back(corners);
  }
  return parts;
}

// Does each edge belong to as many triangles of one direction as of the other?
bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
}

void measure(Part& part) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  part.low = {inf, inf, inf}, part.high = {-inf, -inf, -inf};
  for (const Vec3d& p : part.mesh.vertices)
    for (int k = 0; k < 3; ++k) {
      part.low[k] = std::min(part.low[k], p[k]);
      part.high[k] = std::max(part.high[k], p[k]);
    }
  part.is_closed = is_closed(part.mesh);
  if (!part.is_closed) return;
  const Vec3d reference = 0.5 * (part.low + part.high);
  for (const auto& [i, j, k] : part.mesh.triangles)
    part.volume += dot(part.mesh.vertices[i] - reference,
                       cross(part.mesh.vertices[j] - reference, part.mesh.vertices[k] - reference)) /
                   6;
}

// Points a little way under the largest triangles of a closed part, clearly inside it.
std::vector<Vec3d> points_inside(const Part& part) {
  constexpr std::size_t most_points = 8;
  const auto twice_area = [&](const std::array<std::uint32_t, 3>& t) {
    const Vec3d a = part.mesh.vertices[t[0]];
    return cross(part.mesh.vertices[t[1]] - a, part.mesh.vertices[t[2]] - a);
  };
  std::vector<std::array<std::uint32_t, 3>> largest = part.mesh.triangles;
  std::ranges::stable_sort(
      largest, [&](const auto& a, const auto& b) { return norm2(twice_area(a)) > norm2(twice_area(b)); });
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < largest.size() && points.size() < most_points; ++i) {
    const Vec3d area = twice_area(largest[i]);
    if (!(norm(area) > 0)) break;
    const auto& [p, q, r] = largest[i];
    const Vec3d centroid =
        (1.0 / 3) * (part.mesh.vertices[p] + part.mesh.vertices[q] + part.mesh.vertices[r]);
    const double way = (part.volume > 0 ? -1e-2 : 1e-2) / std::sqrt(norm(area));
    const Vec3d point = centroid + way * area;
    if (std::abs(std::abs(winding_number(part.mesh, point)) - 1) < 1e-3) points.push_back(point);
  }
  return points;
}

// Corners of `inner` may be on the surface of `outer`, so points inside it decide, if all of them agree.
bool is_inside(const Part& inner, const Part& outer) {
  for (int k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k]) return false;
  const std::vector<Vec3d> points = points_inside(inner);
  return !points.empty() && std::ranges::all_of(points, [&](Vec3d point) {
    return std::abs(winding_number(outer.mesh, point)) > 0.5;
  });
}

}  // namespace closed_parts

TurnedParts turn_outwards(TriangleMesh& mesh, const std::vector<std::size_t>& part) {
  std::vector<closed_parts::Part> parts = closed_parts::parts_of(mesh, part);
  std::ranges::for_each(parts, closed_parts::measure);
  std::vector<std::size_t> closed;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].is_closed) closed.push_back(i);
  for (const std::size_t i : closed)
    for (const std::size_t k : closed)
      if (i != k && closed_parts::is_inside(parts[i], parts[k])) parts[i].around.push_back(k);
  // A part turns with the outermost part around it.
  TurnedParts turned;
  std::vector<bool> turns(parts.size());
  for (const std::size_t i : closed) {
    const auto outermost =
        std::ranges::find_if(parts[i].around, [&](std::size_t k) { return parts[k].around.empty(); });
    const closed_parts::Part& outer = outermost == parts[i].around.end() ? parts[i] : parts[*outermost];
    turns[i] = outer.volume < 0;
    if (turns[i]) ++(parts[i].volume < 0 ? turned.outwards : turned.inwards);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (turns[part[t]]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return turned;
}

}  // namespace tandem::launch
