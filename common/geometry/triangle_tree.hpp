// Nearest points of a triangle mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

// The point of the triangle a b c that is nearest to x [Ericson2005, 5.1.5].
Vec3d nearest_point(Vec3d a, Vec3d b, Vec3d c, Vec3d x);

// Boxes about the triangles of a mesh, as a binary tree.
class TriangleTree {
 public:
  struct Nearest {
    std::uint32_t triangle = 0;
    Vec3d point;          // [m]
    double distance = 0;  // [m]
  };

  explicit TriangleTree(const TriangleMesh& mesh);

  // The nearest point that is at most `limit` [m] from x, of the triangles that `accept(triangle)` takes; of
  // triangles that are as near, that of the lowest number.
  template <class Accept>
  std::optional<Nearest> nearest(Vec3d x, double limit, Accept accept) const;
  std::optional<Nearest> nearest(Vec3d x, double limit) const {
    return nearest(x, limit, [](std::uint32_t) { return true; });
  }
  // Is any point of the mesh at most `limit` [m] from x?
  bool is_within(Vec3d x, double limit) const;

 private:
  struct Box {
    Vec3d low, high;                     // [m]
    std::uint32_t begin = 0, count = 0;  // triangles of a leaf
    std::uint32_t second = 0;            // of an inner box: the second half; the first one follows the box

    double distance2(Vec3d x) const {
      double sum = 0;
      for (int a = 0; a < 3; ++a) {
        const double beyond = std::max({low[a] - x[a], x[a] - high[a], 0.0});
        sum += beyond * beyond;
      }
      return sum;
    }
  };
  struct Corners {
    Vec3d a, b, c;  // [m]
  };
  // Calls each(triangle), nearer boxes first, for those whose box is nearer than the root of limit2, which
  // may shrink meanwhile, until it returns false.
  template <class Visit>
  void visit(Vec3d x, const double& limit2, Visit each) const;
  void add(std::uint32_t begin, std::uint32_t end, const std::vector<Vec3d>& centre);

  std::vector<Corners> corners_;
  std::vector<std::uint32_t> order_;  // of triangles
  std::vector<Box> boxes_;
};

template <class Visit>
void TriangleTree::visit(Vec3d x, const double& limit2, Visit each) const {
  std::array<std::uint32_t, 64> open{};  // the tree is balanced
  std::size_t count = 0;
  if (!boxes_.empty()) open[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = open[--count];
    const Box& box = boxes_[number];
    if (box.distance2(x) > limit2) continue;
    if (box.count == 0) {
      const std::uint32_t first = number + 1;
      const bool swap = boxes_[box.second].distance2(x) < boxes_[first].distance2(x);
      open[count++] = swap ? first : box.second;
      open[count++] = swap ? box.second : first;
      continue;
    }
    for (std::uint32_t k = box.begin; k < box.begin + box.count; ++k)
      if (!each(order_[k])) return;
  }
}

template <class Accept>
std::optional<TriangleTree::Nearest> TriangleTree::nearest(Vec3d x, double limit, Accept accept) const {
  std::optional<Nearest> found;
  double best2 = limit * limit;
  visit(x, best2, [&](std::uint32_t triangle) {
    if (!accept(triangle)) return true;
    const Corners& t = corners_[triangle];
    const Vec3d point = nearest_point(t.a, t.b, t.c, x);
    const double distance2 = norm2(point - x);
    if (distance2 > best2 || (distance2 == best2 && found && found->triangle < triangle)) return true;
    best2 = distance2;
    found = {triangle, point, std::sqrt(distance2)};
    return true;
  });
  return found;
}

}  // namespace tandem
