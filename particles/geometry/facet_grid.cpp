#include "particles/geometry/facet_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/error.hpp"
#include "common/geometry/bounds.hpp"

namespace tandem::particles {
namespace {

struct CellBox {
  std::array<std::int32_t, 3> low, high;  // cells [low, high)
};

struct Entry {
  std::uint32_t cell, facet;
};

// Finds boxes with a point within `reach` of a triangle. The gap between the projections on any unit axis is
// a lower bound of the distance. These 13 axes decide exactly whether box and triangle intersect (T.
// Akenine-Möller: "Fast 3D triangle-box overlap testing", Journal of Graphics Tools 6 (2001)); here they
// reject boxes at distances slightly above `reach`. The extents of the triangle are computed once.
class TriangleNeighbourhood {
 public:
  TriangleNeighbourhood(const Facet& t, double reach) {
    const std::array<Vec3d, 3> unit{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    const std::array<Vec3d, 3> edge{t.b - t.a, t.c - t.b, t.a - t.c};
    const auto add = [&](Vec3d axis) {
      const double length = norm(axis);
      if (!(length > 0)) return;  // an edge along an axis of the grid
      axis *= 1 / length;
      const double a = dot(axis, t.a), b = dot(axis, t.b), c = dot(axis, t.c);
      slabs_[count_++] = {axis, std::min({a, b, c}) - reach, std::max({a, b, c}) + reach};
    };
    for (const Vec3d& axis : unit) add(axis);
    add(cross(edge[0], edge[1]));
    for (const Vec3d& e : edge) {
      for (const Vec3d& axis : unit) add(cross(e, axis));
    }
  }

  bool intersects(Vec3d centre, Vec3d half) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Slab& s = slabs_[i];
      const double at = dot(s.axis, centre);
      const double box =
          half.x * std::abs(s.axis.x) + half.y * std::abs(s.axis.y) + half.z * std::abs(s.axis.z);
      if (at + box < s.low || at - box > s.high) return false;
    }
    return true;
  }

 private:
  struct Slab {
    Vec3d axis;        // unit
    double low, high;  // extent of the triangle's neighbourhood along it [m]
  };
  std::array<Slab, 13> slabs_;
  std::size_t count_ = 0;
};

// Finds boxes with a point within `reach` of the surface of a ball: those near enough to its centre that are
// not deep inside it.
class BallNeighbourhood {
 public:
  BallNeighbourhood(const Facet& ball, double reach)
      : middle_(ball.a), within_(ball.radius() + reach), beyond_(std::max(0.0, ball.radius() - reach)) {}

  bool intersects(Vec3d centre, Vec3d half) const {
    double nearest2 = 0, farthest2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double offset = std::abs(middle_[a] - centre[a]);
      const double near = std::max(0.0, offset - half[a]), far = offset + half[a];
      nearest2 += near * near;
      farthest2 += far * far;
    }
    return nearest2 <= within_ * within_ && farthest2 >= beyond_ * beyond_;
  }

 private:
  Vec3d middle_;
  double within_, beyond_;  // distances from the centre [m]
};

class Filling {
 public:
  Filling(const FacetGrid& grid, double reach, std::size_t limit)
      : grid_(grid), reach_(reach), limit_(limit) {}

  bool full() const { return entries_.size() > limit_; }
  const std::vector<Entry>& entries() const { return entries_; }

  void add(const Facet& facet, std::uint32_t index) {
    const CellBox all{{0, 0, 0}, {grid_.cells[0], grid_.cells[1], grid_.cells[2]}};
    if (facet.kind == FacetKind::ball)
      add(BallNeighbourhood(facet, reach_), index, all);
    else
      add(TriangleNeighbourhood(facet, reach_), index, all);
  }

 private:
  // Bisects the block of cells down to single cells near the facet.
  template <class Neighbourhood>
  void add(const Neighbourhood& near, std::uint32_t index, const CellBox& block) {
    std::array<double, 3> middle{}, half{};
    std::size_t longest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      middle[a] = 0.5 * grid_.cell * (block.low[a] + block.high[a]);
      half[a] = 0.5 * grid_.cell * (block.high[a] - block.low[a]);
      if (half[a] > half[longest]) longest = a;
    }
    const Vec3d centre = grid_.origin + Vec3d{middle[0], middle[1], middle[2]};
    if (full() || !near.intersects(centre, {half[0], half[1], half[2]})) return;
    const std::int32_t length = block.high[longest] - block.low[longest];
    if (length == 1) {
      const auto row = static_cast<std::uint32_t>(block.low[2] * grid_.cells[1] + block.low[1]);
      const auto columns = static_cast<std::uint32_t>(grid_.cells[0]);
      entries_.push_back({row * columns + static_cast<std::uint32_t>(block.low[0]), index});
      return;
    }
    CellBox low = block, high = block;
    low.high[longest] = high.low[longest] = block.low[longest] + length / 2;
    add(near, index, low);
    add(near, index, high);
  }

  const FacetGrid& grid_;
  double reach_;
  std::size_t limit_;
  std::vector<Entry> entries_;
};

// Lists every `stride`-th facet.
Filling listed(std::span<const Facet> facets, std::uint32_t first_facet, const FacetGrid& grid, double reach,
               std::size_t limit, std::size_t stride) {
  Filling filling(grid, reach, limit / stride);
  for (std::size_t i = 0; i < facets.size() && !filling.full(); i += stride) {
    filling.add(facets[i], first_facet + static_cast<std::uint32_t>(i));
  }
  return filling;
}

Bounds bounds_of_facets(std::span<const Facet> facets) {
  Bounds box;
  for (const Facet& f : facets) {
    if (f.kind == FacetKind::ball)
      box.add(f.a, f.radius());
    else
      for (const Vec3d& v : {f.a, f.b, f.c}) box.add(v);
  }
  return box;
}

}  // namespace

FacetGrid make_facet_grid(std::span<const Facet> facets, std::uint32_t first_facet, double reach,
                          GridBudget budget, std::vector<std::uint32_t>& cell_start,
                          std::vector<std::uint32_t>& cell_facet) {
  if (cell_start.empty()) cell_start.push_back(0);
  FacetGrid grid;
  grid.first_cell = static_cast<std::uint32_t>(cell_start.size() - 1);
  if (facets.empty()) return grid;

  const Bounds box = bounds_of_facets(facets);
  const Vec3d size = box.high - box.low;
  // Rounding may put a point into an adjacent cell, so the lists reach slightly further than promised.
  const double wide = reach + 1e-9 * (reach + norm(size) + norm(box.low));
  grid.origin = box.low - Vec3d{wide, wide, wide};

  // Cells with the edge of one reach keep the lists of finely meshed walls short.
  for (double cell = wide;; cell *= 1.5) {
    double cells = 1;
    std::array<double, 3> along{};
    for (int a = 0; a < 3; ++a) {
      along[static_cast<std::size_t>(a)] = std::max(1.0, std::ceil((size[a] + 2 * wide) / cell));
      cells *= along[static_cast<std::size_t>(a)];
    }
    if (cells > static_cast<double>(budget.cells)) continue;
    grid.cell = cell;
    for (std::size_t a = 0; a < 3; ++a) grid.cells[a] = static_cast<std::int32_t>(along[a]);

    // A sample of some hundred facets quickly finds cells that are too small; all facets decide in the end.
    const std::size_t stride = facets.size() / 500;
    const bool one_cell = cells == 1;
    if (stride > 1 && !one_cell && listed(facets, first_facet, grid, wide, budget.entries, stride).full())
      continue;
    const Filling filling = listed(facets, first_facet, grid, wide, budget.entries, 1);
    if (filling.full()) {
      if (!one_cell) continue;
      throw Error(ErrorCode::resource,
                  std::to_string(facets.size()) + " facets on one body; at most " +
                      std::to_string(budget.entries) + " can be searched",
                  "walls", "use coarser meshes, or fewer spheres");
    }

    // Counting sort by cell; the facets of a cell stay in ascending order.
    const std::size_t base = cell_facet.size(), count = static_cast<std::size_t>(cells);
    std::vector<std::uint32_t> next(count + 1, 0);
    for (const Entry& e : filling.entries()) ++next[e.cell + 1];
    for (std::size_t c = 0; c < count; ++c) {
      next[c + 1] += next[c];
      cell_start.push_back(static_cast<std::uint32_t>(base + next[c + 1]));
    }
    cell_facet.resize(base + filling.entries().size());
    for (const Entry& e : filling.entries()) cell_facet[base + next[e.cell]++] = e.facet;
    return grid;
  }
}

}  // namespace tandem::particles
