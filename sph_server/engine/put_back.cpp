#include "sph_server/engine/put_back.hpp"

#include <algorithm>
#include <limits>

namespace tandem::sph {
namespace {

constexpr double nearby = 8, off_walls = 1;  // spacings

std::vector<Vec3d> within(double radius, Vec3d of, const std::vector<Vec3d>& points) {
  std::vector<Vec3d> near;
  for (const Vec3d& x : points)
    if (norm2(x - of) < radius * radius) near.push_back(x);
  return near;
}

bool is_beside_wall(Vec3d x, double distance, const WallsView& walls) {
  bool beside = false;
  walls.for_near(x, distance, [&](std::uint32_t facet) {
    beside = walls.is_within(distance, x, facet);
    return !beside;
  });
  return beside;
}

}  // namespace

bool put_back(std::vector<Vec3d>& places, const std::vector<std::size_t>& left,
              const std::vector<Vec3d>& sites, const Walls& walls, double spacing) {
  const WallsView view = walls.view();
  for (const std::size_t i : left) {
    const std::vector<Vec3d> others = within((nearby + 1) * spacing, sites[i], places);
    double widest = 0;
    Vec3d best;
    for (const Vec3d& site : within(nearby * spacing, sites[i], sites)) {
      double gap = std::numeric_limits<double>::infinity();
      for (const Vec3d& x : others) gap = std::min(gap, norm2(x - site));
      if (gap <= widest || is_beside_wall(site, off_walls * spacing, view)) continue;
      widest = gap;
      best = site;
    }
    if (!(widest > 0)) return false;
    places[i] = best;
  }
  return true;
}

}  // namespace tandem::sph
