#include "particles/grid/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "common/scene/fault.hpp"

namespace tandem::particles {
namespace {

constexpr std::uint32_t most_numbers = 1u << 31;  // of cells, limited by int

// Number of whole cells in a period.
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

// Cells with the edge `cell`, or longer along a periodic axis.
CellGrid divided(const scene::Box& domain, const Periods& periods, double least, double cell) {
  CellGrid g;
  g.origin = domain.min;
  double total = 64;
  for (int a = 0; a < 3; ++a) {
    g.periodic[a] = periods.length[a] > 0;
    if (g.periodic[a]) {
      g.cells[a] = cells_of(periods.length[a], least, cell, a);
      // Slightly less, so that no position before the end of the domain is rounded into a cell beyond the
      // last.
      g.inverse_cell[a] = g.cells[a] / periods.length[a] * (1 - 1e-15);
    } else {
      g.inverse_cell[a] = 1 / cell;
      g.cells[a] = static_cast<std::int32_t>(std::min((domain.max - domain.min)[a] / cell, 2e9)) + 1;
    }
    if (1 / g.inverse_cell[a] > 1.0001 * least) g.apart2 = 4 * least * least;
    g.blocks[a] = g.cells[a] / 4 + (g.cells[a] % 4 == 0 ? 0 : 1);
    total *= g.blocks[a];
  }
  g.total = total < most_numbers ? static_cast<std::uint32_t>(total) : most_numbers;
  return g;
}

}  // namespace

double most_cells(std::size_t spheres) {
  return std::clamp(2.0 * static_cast<double>(spheres), 16e6, 0.2 * most_numbers);
}

CellGrid make_cell_grid(const scene::Box& domain, const Periods& periods, double least, double most) {
  // In a domain that is vast compared with its spheres, larger cells limit the memory of empty space.
  const Vec3d size = domain.max - domain.min;
  double cell = std::max(least, std::cbrt(size.x * size.y * size.z / most));
  CellGrid g = divided(domain, periods, least, cell);
  // Cells are numbered by blocks; a domain that is thinner than a block leaves most of these numbers unused.
  while (g.total > 4 * most) g = divided(domain, periods, least, cell *= 1.25);
  return g;
}

std::string warn_of_full_cells(const CellGrid& grid, const scene::Box& domain, double needed,
                               const std::vector<double>& radii) {
  constexpr double packed = 0.6;  // share of the volume in a dense bed
  // With equal spheres there are 2 in a cell. With 50 a rebuild takes some 30 times longer, which is
  // noticeable in a run.
  constexpr double tolerable = 50, cells_around = 27;
  const auto n = static_cast<double>(radii.size());
  const double largest = *std::max_element(radii.begin(), radii.end());
  double volume = 0, edge = 0, cell = 1;
  for (const double r : radii) volume += 4.0 / 3.0 * std::numbers::pi * r * r * r;
  for (int a = 0; a < 3; ++a) {
    edge = std::max(edge, 1 / grid.inverse_cell[a]);
    // Centres are within the domain, which may be thinner than a cell.
    cell *= std::min(1 / grid.inverse_cell[a], (domain.max - domain.min)[a] + 2 * largest);
  }
  const double held = std::min(n, packed * cell * n / volume);
  if (edge <= 1.5 * needed || held <= tolerable || n <= cells_around * tolerable) return {};
  return "lists of neighbours take long to build: cells are " + scene::rounded(edge) +
         " m wide, as the domain is vast, and hold up to " + scene::rounded(std::round(held)) +
         " spheres each: make dem.domain no larger than where spheres go";
}

}  // namespace tandem::particles
