#include "particles/grid/size_levels.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::particles {
namespace {

constexpr double ratio_in_level = 2;
// Number of spheres that a sphere is compared with in a dense bed of its own level: 27 cells with one or two
// spheres each. A level that all spheres search costs each of them about as much.
constexpr double in_own_level = 40;
// The number of cells that is worth its memory falls with each coarser level.
constexpr double fewer_cells = 1.0 / 8, fewest_cells = 4096;

SizeLevels levels_of(const std::vector<double>& limits, const scene::Box& domain, const Periods& periods,
                     std::size_t spheres, const SkinRange& skins, double range) {
  const double largest = limits.back();
  // Bound of the change of radii when they are rounded to quanta. The largest spheres have no larger partner.
  const auto rounding = [&](double limit) { return limit < largest ? 5e-8 * (largest + skins.largest) : 0; };
  const auto grid = [&](double limit, double skin, double cells) {
    CellGrid g = make_cell_grid(domain, periods, 2 * (limit + 2 * rounding(limit)) + skin, cells);
    // Spheres of all sizes search these cells.
    if (const double edge = 2 * largest + skins.largest; g.apart2 > 0) g.apart2 = 4 * edge * edge;
    return g;
  };
  const double cells = most_cells(spheres);
  SizeLevels levels;
  for (std::size_t k = limits.size() - 1; k > 0; --k) {
    const double fewer = std::max(cells * std::pow(fewer_cells, k), fewest_cells);
    levels.coarse.push_back({grid(limits[k], skins.largest, fewer), limits[k] + rounding(limits[k]), 0});
  }
  std::reverse(levels.coarse.begin(), levels.coarse.end());
  std::uint32_t numbers = 0;
  for (CoarseLevel& level : levels.coarse) {
    level.first_cell = numbers;
    numbers += level.grid.total;
  }
  levels.largest_of_finest = limits.front() + rounding(limits.front());
  levels.finest[0] = grid(limits.front(), std::min(skins.usual + range, skins.largest), cells);
  levels.finest[1] = grid(limits.front(), skins.largest, cells);
  return levels;
}

// A sphere that is large compared with the cells of a short period may reach one of them from both ends.
bool reaches_a_cell_twice(const CellGrid& grid, double reach) {
  for (int a = 0; a < 3; ++a)
    if (grid.periodic[a] && 2 * cells_within(grid, a, reach) + 1 > grid.cells[a]) return true;
  return false;
}

// Index of the first of `limits` whose level has such cells; otherwise the number of limits.
std::size_t level_reached_twice(const SizeLevels& levels, const std::vector<double>& limits, double skin) {
  const auto reach = [&](std::size_t k) { return 1.000001 * (limits.back() + limits[k]) + skin; };
  std::size_t k = 0;
  if (limits.size() == 1) return 1;
  for (const CellGrid& grid : levels.finest)
    if (reaches_a_cell_twice(grid, reach(k))) return k;
  for (k = 1; k + 1 < limits.size(); ++k)
    if (reaches_a_cell_twice(levels.coarse[k - 1].grid, reach(k))) return k;
  return limits.size();
}

}  // namespace

std::vector<double> limits_of_levels(const std::vector<double>& radii) {
  struct Level {
    double limit;
    std::size_t count = 0;
  };
  std::vector<Level> levels;  // descending sizes
  double limit = 0;
  for (const double r : radii) limit = std::max(limit, r);
  while (limit > 0) {
    Level level{limit};
    double next = 0;
    for (const double r : radii)
      if (ratio_in_level * r < limit)
        next = std::max(next, r);
      else if (r <= limit)
        ++level.count;
    levels.push_back(level);
    limit = next;
  }
  // Compares the cost of searching the spheres of a level in cells of the next one, all of them in one
  // region, with the cost that cells of their own cause for the spheres of the next level.
  const auto worth_its_cells = [](const Level& fine, const Level& coarse) {
    const double n = static_cast<double>(fine.count), ratio = coarse.limit / fine.limit;
    return n * std::min(n, in_own_level * ratio * ratio * ratio) >
           in_own_level * static_cast<double>(coarse.count);
  };
  std::vector<double> limits;
  for (std::size_t k = levels.size(); k-- > 0;)
    if (k == 0 || worth_its_cells(levels[k], levels[k - 1]))
      limits.push_back(levels[k].limit);
    else
      levels[k - 1].count += levels[k].count;
  return limits;
}

SizeLevels make_size_levels(const scene::Box& domain, const Periods& periods,
                            const std::vector<double>& radii, const SkinRange& skins, double range) {
  std::vector<double> limits = limits_of_levels(radii);
  if (limits.empty()) limits.push_back(0);
  for (;;) {
    SizeLevels levels = levels_of(limits, domain, periods, radii.size(), skins, range);
    const std::size_t twice = level_reached_twice(levels, limits, skins.largest);
    if (twice >= limits.size()) return levels;
    limits.erase(limits.begin() + static_cast<std::ptrdiff_t>(twice));  // the next level takes its spheres
  }
}

}  // namespace tandem::particles
