// Lists of the neighbours of each particle, and whether a wall is between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "particles/base/thread_pool.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/grid/cell_grid.hpp"
#include "sph_server/neighbours/neighbour.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

struct NeighbourList {
  std::vector<std::uint32_t> start;  // of each particle in `neighbour`, and the end (n + 1)
  std::vector<Neighbour> neighbour;  // both particles of a pair list each other
};

// All pairs nearer than `reach` [m] that see each other: no wall is between them. x: positions in the domain
// of the grid [m].
void build_list(const particles::CellGrid& grid, const particles::Periods& periods, std::span<const Vec3d> x,
                double reach, const Walls& walls, particles::ThreadPool& pool, NeighbourList& list);

}  // namespace tandem::sph
