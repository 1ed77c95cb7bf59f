#include "particles/io/vertical_crossings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/bounds.hpp"

namespace tandem::particles {
namespace {

// Whether the edge from a to b crosses the line y towards larger x. Both triangles of an edge compute the
// same, because the ends are ordered.
bool edge_is_beyond(Vec3d a, Vec3d b, double x, double y) {
  if ((a.y > y) == (b.y > y)) return false;
  if (b.y < a.y) std::swap(a, b);
  return x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
}

}  // namespace

VerticalCrossings::VerticalCrossings(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  Bounds bounds;
  for (const auto& t : mesh_.triangles)
    for (const std::uint32_t corner : t) bounds.add(mesh_.vertices[corner]);
  low_ = bounds.low, high_ = bounds.high;
  if (mesh_.triangles.empty()) return;
  const double width = high_.x - low_.x, depth = high_.y - low_.y;
  const auto number = static_cast<double>(mesh_.triangles.size());
  edge_ = std::max({std::sqrt(width * depth / (2 * number + 100)), (width + depth) / 4000, 1e-300});
  cells_[0] = std::floor(width / edge_) + 1;
  cells_[1] = std::floor(depth / edge_) + 1;
  const auto columns = static_cast<std::size_t>(cells_[0]), rows = static_cast<std::size_t>(cells_[1]);
  const auto for_cells = [&](std::uint32_t t, const auto& act) {
    Bounds around;
    for (const std::uint32_t corner : mesh_.triangles[t]) around.add(mesh_.vertices[corner]);
    const Vec3d least = around.low, most = around.high;
    const auto cell = [&](double x, double first, std::size_t cells) {
      return std::min(static_cast<std::size_t>((x - first) / edge_), cells - 1);
    };
    for (std::size_t j = cell(least.y, low_.y, rows), end = cell(most.y, low_.y, rows); j <= end; ++j)
      for (std::size_t i = cell(least.x, low_.x, columns), last = cell(most.x, low_.x, columns); i <= last;
           ++i)
        act(j * columns + i);
  };
  start_.assign(columns * rows + 1, 0);
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangles.size());
  for (std::uint32_t t = 0; t < triangles; ++t) for_cells(t, [&](std::size_t cell) { ++start_[cell + 1]; });
  for (std::size_t c = 0; c + 1 < start_.size(); ++c) start_[c + 1] += start_[c];
  triangles_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t t = 0; t < triangles; ++t)
    for_cells(t, [&](std::size_t cell) { triangles_[next[cell]++] = t; });
}

bool VerticalCrossings::crosses(std::uint32_t triangle, double x, double y, double& z) const {
  const auto& corners = mesh_.triangles[triangle];
  const Vec3d a = mesh_.vertices[corners[0]], b = mesh_.vertices[corners[1]], c = mesh_.vertices[corners[2]];
  if (((edge_is_beyond(a, b, x, y) != edge_is_beyond(b, c, x, y)) != edge_is_beyond(c, a, x, y)) == false)
    return false;
  const Vec3d n = cross(b - a, c - a);
  // Steep triangles give no exact height; their corners limit it.
  const double low = std::min({a.z, b.z, c.z}), high = std::max({a.z, b.z, c.z});
  const double height = n.z != 0 ? a.z - (n.x * (x - a.x) + n.y * (y - a.y)) / n.z : low;
  z = std::clamp(height, low, high);
  return true;
}

double lowest_open_edge(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      edges.emplace_back(std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k;
    while (end < edges.size() && edges[end] == edges[k]) ++end;
    if ((end - k) % 2 == 1)
      lowest = std::min({lowest, mesh.vertices[edges[k].first].z, mesh.vertices[edges[k].second].z});
    k = end;
  }
  return lowest;
}

}  // namespace tandem::particles
