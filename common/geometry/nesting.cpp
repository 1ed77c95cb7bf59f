#include "common/geometry/nesting.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "common/geometry/bounds.hpp"
#include "common/geometry/mass_properties.hpp"

namespace tandem {
namespace nesting {

// Points a little way under the largest triangles of a closed part, clearly inside it.
std::vector<Vec3d> points_inside(const ClosedPart& part) {
  constexpr std::size_t most_points = 8, most_triangles = 64;
  const auto twice_area = [&](const std::array<std::uint32_t, 3>& t) {
    const Vec3d a = part.mesh.vertices[t[0]];
    return cross(part.mesh.vertices[t[1]] - a, part.mesh.vertices[t[2]] - a);
  };
  std::vector<std::array<std::uint32_t, 3>> largest = part.mesh.triangles;
  std::ranges::stable_sort(
      largest, [&](const auto& a, const auto& b) { return norm2(twice_area(a)) > norm2(twice_area(b)); });
  largest.resize(std::min(largest.size(), most_triangles));
  std::vector<Vec3d> points;
  for (const auto& [p, q, r] : largest) {
    const Vec3d area = twice_area({p, q, r});
    if (!(norm(area) > 0)) break;
    const Vec3d centroid =
        (1.0 / 3) * (part.mesh.vertices[p] + part.mesh.vertices[q] + part.mesh.vertices[r]);
    // Sheets are thinner than a hundredth of their triangles.
    for (const double depth : {1e-2, 1e-4}) {
      const Vec3d point = centroid + (part.volume > 0 ? -depth : depth) / std::sqrt(norm(area)) * area;
      if (std::abs(std::abs(winding_number(part.mesh, point)) - 1) > 1e-3) continue;
      points.push_back(point);
      break;
    }
    if (points.size() == most_points) break;
  }
  return points;
}

bool is_within_bounds(const ClosedPart& inner, const ClosedPart& outer) {
  for (int k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k]) return false;
  return true;
}

}  // namespace nesting

ClosedPart closed_part(TriangleMesh mesh) {
  const Bounds bounds = bounds_of(mesh.vertices);
  const double volume = signed_volume(mesh);
  return {std::move(mesh), bounds.low, bounds.high, volume};
}

bool Nesting::is_unclear(std::size_t part) const {
  return std::ranges::any_of(unclear, [&](const auto& pair) { return pair.first == part; });
}

Nesting nesting_of(const std::vector<ClosedPart>& parts) {
  Nesting nesting;
  nesting.around.resize(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::optional<std::vector<Vec3d>> points;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      if (k == i || !nesting::is_within_bounds(parts[i], parts[k])) continue;
      if (!points) points = nesting::points_inside(parts[i]);
      const auto inside = std::ranges::count_if(
          *points, [&](Vec3d point) { return std::abs(winding_number(parts[k].mesh, point)) > 0.5; });
      if (points->empty() || (inside > 0 && inside < std::ssize(*points)))
        nesting.unclear.emplace_back(i, k);
      else if (inside > 0)
        nesting.around[i].push_back(k);
    }
  }
  return nesting;
}

std::string point_text(Vec3d p) {
  std::string text = "[";
  for (int k = 0; k < 3; ++k) {
    std::array<char, 32> buffer{};
    const auto end =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), p[k], std::chars_format::general, 6).ptr;
    text += (k > 0 ? ", " : "") + std::string(buffer.data(), end);
  }
  return text + "]";
}

std::string part_text(const ClosedPart& part) {
  return "the closed part at " + point_text(part.mesh.vertices.front());
}

std::string why_unclear(const ClosedPart& inner, const ClosedPart& outer) {
  return "whether " + part_text(inner) + " is a cavity cannot be judged: it is partly inside " +
         part_text(outer) + ", or too thin to tell";
}

}  // namespace tandem
