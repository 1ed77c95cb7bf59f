#include "sph_server/engine/region_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tandem::sph {
namespace {

// 1 where the edge from a to b passes the line at (x, y) on the side of larger x upwards in y, -1 downwards,
// else 0. Both triangles of an edge get opposite numbers, because the ends are ordered.
int passes(Vec3d a, Vec3d b, double x, double y) {
  if ((a.y > y) == (b.y > y)) return 0;
  int upwards = 1;
  if (b.y < a.y) {
    std::swap(a, b);
    upwards = -1;
  }
  return x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x) ? upwards : 0;
}

}  // namespace

RegionColumns::RegionColumns(const TriangleMesh& mesh, const Vec3d* axis) : mesh_(mesh) {
  constexpr double none = std::numeric_limits<double>::infinity();
  low_ = {none, none, none};
  high_ = -low_;
  for (Vec3d& v : mesh_.vertices) {
    v = {dot(v, axis[0]), dot(v, axis[1]), dot(v, axis[2])};
    for (int a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], v[a]);
      high_[a] = std::max(high_[a], v[a]);
    }
  }
  const double width = high_.x - low_.x, depth = high_.y - low_.y;
  const auto number = static_cast<double>(mesh_.triangles.size());
  edge_ = std::max({std::sqrt(width * depth / (2 * number + 100)), (width + depth) / 4000, 1e-300});
  cells_[0] = static_cast<std::size_t>(width / edge_) + 1;
  cells_[1] = static_cast<std::size_t>(depth / edge_) + 1;
  const auto for_cells = [&](std::uint32_t t, const auto& act) {
    Vec3d least{none, none, none}, most = -least;
    for (const std::uint32_t corner : mesh_.triangles[t])
      for (int a = 0; a < 2; ++a) {
        least[a] = std::min(least[a], mesh_.vertices[corner][a]);
        most[a] = std::max(most[a], mesh_.vertices[corner][a]);
      }
    for (std::size_t j = cell(least.y, low_.y, cells_[1]), end = cell(most.y, low_.y, cells_[1]); j <= end;
         ++j)
      for (std::size_t i = cell(least.x, low_.x, cells_[0]), last = cell(most.x, low_.x, cells_[0]);
           i <= last; ++i)
        act(j * cells_[0] + i);
  };
  start_.assign(cells_[0] * cells_[1] + 1, 0);
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangles.size());
  for (std::uint32_t t = 0; t < triangles; ++t) for_cells(t, [&](std::size_t c) { ++start_[c + 1]; });
  for (std::size_t c = 0; c + 1 < start_.size(); ++c) start_[c + 1] += start_[c];
  triangle_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t t = 0; t < triangles; ++t)
    for_cells(t, [&](std::size_t c) { triangle_[next[c]++] = t; });
}

std::size_t RegionColumns::cell(double x, double low, std::size_t cells) const {
  return std::min(static_cast<std::size_t>((x - low) / edge_), cells - 1);
}

void RegionColumns::find(double x, double y, ColumnCrossings& found) const {
  found.crossing_.clear();
  if (!(x >= low_.x && x <= high_.x && y >= low_.y && y <= high_.y)) return;
  const std::size_t column = cell(y, low_.y, cells_[1]) * cells_[0] + cell(x, low_.x, cells_[0]);
  for (std::uint32_t k = start_[column]; k < start_[column + 1]; ++k) {
    const auto& corners = mesh_.triangles[triangle_[k]];
    const Vec3d a = mesh_.vertices[corners[0]], b = mesh_.vertices[corners[1]],
                c = mesh_.vertices[corners[2]];
    // 1 for a triangle that is seen counterclockwise from above: its normal is upwards, out of the mesh.
    const int outwards = passes(a, b, x, y) + passes(b, c, x, y) + passes(c, a, x, y);
    if (outwards == 0) continue;
    // Steep triangles give no exact height; their corners limit it.
    const Vec3d n = cross(b - a, c - a);
    const double low = std::min({a.z, b.z, c.z}), high = std::max({a.z, b.z, c.z});
    const double height = n.z != 0 ? a.z - (n.x * (x - a.x) + n.y * (y - a.y)) / n.z : low;
    found.crossing_.push_back({std::clamp(height, low, high), -outwards});
  }
  std::ranges::stable_sort(found.crossing_, {}, &ColumnCrossings::Crossing::z);
}

}  // namespace tandem::sph
