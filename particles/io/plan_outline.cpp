#include "particles/io/plan_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace tandem::particles {
namespace {

constexpr double boundless = std::numeric_limits<double>::infinity();
constexpr int cells_along = 64;

double turn(Vec3d a, Vec3d b) {
  return a.x * b.y - a.y * b.x;
}

Vec3d flat(Vec3d p) {
  return {p.x, p.y, 0};
}

Vec3d nearest_of(Vec3d a, Vec3d b, Vec3d p) {
  const Vec3d along = b - a;
  return a + std::clamp(dot(p - a, along) / norm2(along), 0.0, 1.0) * along;
}

}  // namespace

PlanOutline::PlanOutline(const TriangleMesh& mesh, const std::function<bool(double, double)>& covers,
                         double reach) {
  low_ = {boundless, boundless, 0};
  high_ = {-boundless, -boundless, 0};
  // Which sides of an edge have triangles: 1 left, 2 right.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = flat(mesh.vertices[t[0]]), b = flat(mesh.vertices[t[1]]), c = flat(mesh.vertices[t[2]]);
    for (const Vec3d p : {a, b, c})
      for (int k = 0; k < 2; ++k) low_[k] = std::min(low_[k], p[k]), high_[k] = std::max(high_[k], p[k]);
    const double area = turn(b - a, c - a);
    const double longest = std::max({norm2(b - a), norm2(c - a), norm2(c - b)});
    if (std::abs(area) <= 1e-12 * longest) continue;  // upright
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      const bool is_left = (area > 0) == (from < to);
      sides[{std::min(from, to), std::max(from, to)}] |= is_left ? 1 : 2;
    }
  }
  const Vec3d size = high_ - low_;
  const double tiny = 1e-7 * (size.x + size.y);
  bool is_box = true;
  for (const auto& [edge, side] : sides) {
    if (side == 3) continue;
    const Vec3d from = flat(mesh.vertices[edge.first]), to = flat(mesh.vertices[edge.second]),
                along = to - from;
    if (!(norm(along) > 0)) continue;
    const Vec3d left = normalized(Vec3d{-along.y, along.x, 0}), inwards = side == 1 ? left : -left;
    const bool is_free = std::ranges::any_of(std::initializer_list<double>{0.1, 0.5, 0.9}, [&](double part) {
      const Vec3d beyond = from + part * along - tiny * inwards;
      return !covers(beyond.x, beyond.y);
    });
    if (!is_free) continue;
    edges_.push_back({from, to, inwards});
    const auto on_side = [&](int k, double at) {
      return std::abs(from[k] - at) <= tiny && std::abs(to[k] - at) <= tiny;
    };
    is_box =
        is_box && (on_side(0, low_.x) || on_side(0, high_.x) || on_side(1, low_.y) || on_side(1, high_.y));
  }
  if (is_box) edges_.clear();
  if (!edges_.empty()) make_cells(reach);
}

void PlanOutline::make_cells(double reach) {
  const Vec3d cell = (1.0 / cells_along) * (high_ - low_);
  const double far = reach + 0.5 * std::hypot(cell.x, cell.y);
  near_.resize(std::size_t{cells_along} * cells_along);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const Vec3d middle{low_.x + (static_cast<double>(k % cells_along) + 0.5) * cell.x,
                       low_.y + (static_cast<double>(k / cells_along) + 0.5) * cell.y, 0};
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      if (norm(middle - nearest_of(edges_[e].from, edges_[e].to, middle)) <= far) near_[k].push_back(e);
  }
}

PlanOutline::Nearest PlanOutline::nearest(Vec3d p) const {
  Nearest best{boundless, {}, {}};
  const auto look_at = [&](const Edge& edge) {
    const Vec3d q = nearest_of(edge.from, edge.to, p);
    const double distance = norm(p - q);
    if (distance < best.distance) best = {distance, q, edge.inwards};
  };
  const auto cell = [&](int k) {
    const double at = (p[k] - low_[k]) / (high_[k] - low_[k]) * cells_along;
    return static_cast<std::size_t>(std::clamp(at, 0.0, cells_along - 1.0));
  };
  for (const std::uint32_t e : near_[cell(1) * cells_along + cell(0)]) look_at(edges_[e]);
  return best;
}

Vec3d PlanOutline::moved_inside(Vec3d p, double radius, bool is_covered) const {
  // In a corner the sphere leaves one edge after the other.
  for (int round = 0; round < 4; ++round) {
    Nearest found = nearest(flat(p));
    if (is_covered && found.distance >= radius) return p;
    if (found.distance == boundless) {  // far beyond
      for (const Edge& edge : edges_) {
        const Vec3d q = nearest_of(edge.from, edge.to, flat(p));
        if (const double distance = norm(flat(p) - q); distance < found.distance)
          found = {distance, q, edge.inwards};
      }
    }
    const Vec3d line = is_covered ? flat(p) - found.point : found.point - flat(p);
    const double length = norm(line);
    const Vec3d inwards = length > 1e-9 * radius ? (1 / length) * line : found.inwards;
    p = Vec3d{found.point.x, found.point.y, p.z} + radius * inwards;
    is_covered = true;
  }
  return p;
}

}  // namespace tandem::particles
