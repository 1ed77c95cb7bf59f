// Lists of the neighbours of each particle, and whether a wall is between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "particles/base/thread_pool.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/grid/cell_grid.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

// A neighbour and the period by which it is shifted: 26 bits of index, 6 bits of dem::Image.
class Neighbour {
 public:
  static constexpr std::uint32_t most = 1u << 26;
  Neighbour() = default;
  TANDEM_HD Neighbour(std::uint32_t index, dem::Image image) : word_(std::uint32_t{image} << 26 | index) {}
  TANDEM_HD std::uint32_t index() const { return word_ & (most - 1); }
  TANDEM_HD dem::Image image() const { return static_cast<dem::Image>(word_ >> 26); }

 private:
  std::uint32_t word_ = 0;
};

struct NeighbourList {
  std::vector<std::uint32_t> start;  // of each particle in `neighbour`, and the end (n + 1)
  std::vector<Neighbour> neighbour;  // both particles of a pair list each other
};

// All pairs nearer than `reach` [m] that see each other: no wall is between them. x: positions in the domain
// of the grid [m].
void build_list(const dem::CellGrid& grid, const dem::Periods& periods, std::span<const Vec3d> x,
                double reach, const Walls& walls, dem::ThreadPool& pool, NeighbourList& list);

}  // namespace tandem::sph
