#include "common/geometry/triangle_tree.hpp"

#include <numeric>
#include <utility>

namespace tandem {

Vec3d nearest_point(Vec3d a, Vec3d b, Vec3d c, Vec3d x) {
  const Vec3d ab = b - a, ac = c - a, ax = x - a;
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = dot(ab, x - b), d4 = dot(ac, x - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
  const double d5 = dot(ab, x - c), d6 = dot(ac, x - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double of_b = d5 * d2 - d1 * d6;
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
  const double of_a = d3 * d6 - d5 * d4;
  if (of_a <= 0 && d4 >= d3 && d5 >= d6) return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
  const double sum = of_a + of_b + of_c;
  return a + (of_b / sum) * ab + (of_c / sum) * ac;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  std::vector<Vec3d> centre;
  for (const auto& t : mesh.triangles) {
    corners_.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    centre.push_back(1.0 / 3 * (corners_.back().a + corners_.back().b + corners_.back().c));
  }
  order_.resize(corners_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) add(0, static_cast<std::uint32_t>(order_.size()), centre);
}

bool TriangleTree::is_within(Vec3d x, double limit) const {
  bool found = false;
  const double limit2 = limit * limit;
  visit(x, limit2, [&](std::uint32_t triangle) {
    const Corners& t = corners_[triangle];
    found = norm2(nearest_point(t.a, t.b, t.c, x) - x) <= limit2;
    return !found;
  });
  return found;
}

void TriangleTree::add(std::uint32_t begin, std::uint32_t end, const std::vector<Vec3d>& centre) {
  constexpr std::uint32_t of_leaf = 4;
  const std::size_t number = boxes_.size();
  Box box;
  box.low = box.high = corners_[order_[begin]].a;
  for (std::uint32_t k = begin; k < end; ++k)
    for (const Vec3d& corner : {corners_[order_[k]].a, corners_[order_[k]].b, corners_[order_[k]].c})
      for (int a = 0; a < 3; ++a) {
        box.low[a] = std::min(box.low[a], corner[a]);
        box.high[a] = std::max(box.high[a], corner[a]);
      }
  boxes_.push_back(box);
  if (end - begin <= of_leaf) {
    boxes_[number].begin = begin;
    boxes_[number].count = end - begin;
    return;
  }
  int along = 0;
  for (int a = 1; a < 3; ++a)
    if (box.high[a] - box.low[a] > box.high[along] - box.low[along]) along = a;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t f, std::uint32_t g) {
                     return std::pair(centre[f][along], f) < std::pair(centre[g][along], g);
                   });
  add(begin, middle, centre);
  boxes_[number].second = static_cast<std::uint32_t>(boxes_.size());
  add(middle, end, centre);
}

}  // namespace tandem
