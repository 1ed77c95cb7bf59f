#include "dem_server/neighbours/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "common/scene/fault.hpp"

namespace tandem::dem {
namespace {

// Whole cells of a period.
std::int32_t cells_of(double period, double least, double cell, int axis) {
  constexpr double fewest = 3;
  if (period < fewest * least)
    throw Error(ErrorCode::scene,
                "the domain is " + scene::rounded(period) + " m long along the periodic axis " + "xyz"[axis],
                "dem.domain",
                "give it at least " + scene::rounded(fewest * least) +
                    " m: three times the largest diameter and the skin of the neighbour list");
  return static_cast<std::int32_t>(std::max(fewest, std::floor(period / cell)));
}

}  // namespace

CellGrid make_cell_grid(const scene::Box& domain, const Periods& periods, double least, std::size_t spheres) {
  // A domain that is vast beside its spheres gets larger cells, so that empty space costs little memory.
  const double most_cells = std::clamp(2.0 * static_cast<double>(spheres), 16e6, 1e9);
  const Vec3d size = domain.max - domain.min;
  const double cell = std::max(least, std::cbrt(size.x * size.y * size.z / most_cells));
  CellGrid g;
  g.origin = domain.min;
  for (int a = 0; a < 3; ++a) {
    g.periodic[a] = periods.length[a] > 0;
    if (g.periodic[a]) {
      g.cells[a] = cells_of(periods.length[a], least, cell, a);
      // A little less, so that no place before the domain's end is rounded into a cell beyond the last.
      g.inverse_cell[a] = g.cells[a] / periods.length[a] * (1 - 1e-15);
    } else {
      g.inverse_cell[a] = 1 / cell;
      g.cells[a] = static_cast<std::int32_t>(size[a] / cell) + 1;
    }
    if (1 / g.inverse_cell[a] > 1.0001 * least) g.apart2 = 4 * least * least;
    g.blocks[a] = (g.cells[a] + 3) / 4;
  }
  g.total = static_cast<std::uint32_t>(g.blocks[0] * g.blocks[1] * g.blocks[2] * 64);
  return g;
}

std::string warn_of_full_cells(const CellGrid& grid, double needed, const std::vector<double>& radii) {
  constexpr double packed = 0.6;  // share of the volume in a dense bed
  // Equal spheres have 2 in a cell. With 50 a rebuild takes some 30 times longer, which shows in a run.
  constexpr double tolerable = 50, cells_around = 27;
  const auto n = static_cast<double>(radii.size());
  double volume = 0, edge = 0;
  for (const double r : radii) volume += 4.0 / 3.0 * std::numbers::pi * r * r * r;
  for (int a = 0; a < 3; ++a) edge = std::max(edge, 1 / grid.inverse_cell[a]);
  const double held = std::min(n, packed * edge * edge * edge * n / volume);
  if (held <= tolerable || n <= cells_around * tolerable) return {};
  const bool vast = edge > 1.5 * needed;
  return "lists of neighbours take long to build: cells are " + scene::rounded(edge) + " m wide, as " +
         (vast ? "the domain is vast,"
               : "the largest sphere needs (radius " +
                     scene::rounded(*std::max_element(radii.begin(), radii.end())) + " m),") +
         " and hold up to " + scene::rounded(std::round(held)) + " spheres each: " +
         (vast ? "make dem.domain no larger than where spheres go"
               : "let spheres that are so much larger be bodies with a wall of shape 'sphere'");
}

}  // namespace tandem::dem
