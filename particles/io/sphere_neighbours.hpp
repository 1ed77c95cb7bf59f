// Neighbours of spheres of unlike sizes.
#pragma once

#include <cstdint>
#include <vector>

#include "particles/base/thread_pool.hpp"
#include "particles/io/packed_spheres.hpp"

namespace tandem::particles {

// Calls act(thread, begin, end) for consecutive ranges of 0..count-1, one for each thread.
template <class Act>
void for_ranges(ThreadPool& pool, std::size_t count, const Act& act) {
  const std::size_t threads = pool.size();
  pool.run([&](unsigned thread) { act(thread, count * thread / threads, count * (thread + 1) / threads); });
}

// Cells of spheres whose radii differ by less than a factor of two each; every sphere is in the cell of its
// centre.
class SphereLevels {
 public:
  explicit SphereLevels(const PackedSpheres& spheres);

  // Calls f(j) for all spheres j but `self` that may be closer than (1 + margin) (radius + radius of j) to
  // `centre`.
  template <class F>
  void for_near(Vec3d centre, double radius, double margin, std::size_t self, F f) const {
    for (const Level& level : levels_) {
      const double reach = (1 + margin) * (radius + level.largest);
      std::int64_t low[3], high[3];
      bool none = false;
      for (int a = 0; a < 3; ++a) {
        const double first = (centre[a] - reach - level.low[a]) / level.edge,
                     last = (centre[a] + reach - level.low[a]) / level.edge;
        none = none || last < 0 || first >= static_cast<double>(level.cells[a]);
        if (none) break;
        low[a] = first < 0 ? 0 : static_cast<std::int64_t>(first);
        high[a] =
            last < static_cast<double>(level.cells[a]) ? static_cast<std::int64_t>(last) : level.cells[a] - 1;
      }
      if (none) continue;
      for (std::int64_t z = low[2]; z <= high[2]; ++z)
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          const std::size_t row = static_cast<std::size_t>((z * level.cells[1] + y) * level.cells[0]);
          const std::uint32_t begin = level.start[row + static_cast<std::size_t>(low[0])],
                              end = level.start[row + static_cast<std::size_t>(high[0]) + 1];
          for (std::uint32_t k = begin; k < end; ++k)
            if (level.spheres[k] != self) f(level.spheres[k]);
        }
    }
  }

 private:
  struct Level {
    double largest = 0, edge = 0;  // [m]
    Vec3d low;                     // corner of the first cell [m]
    std::int64_t cells[3]{};
    std::vector<std::uint32_t> start;    // (cells + 1) offsets into `spheres`
    std::vector<std::uint32_t> spheres;  // ascending in each cell
  };
  std::vector<Level> levels_;
};

// The neighbours of each moving sphere: all spheres closer than (1 + margin) times the sum of the radii.
class NeighbourList {
 public:
  void build(const PackedSpheres& spheres, double margin, ThreadPool& pool);
  template <class F>
  void for_neighbours(std::size_t i, F f) const {
    const std::vector<std::uint32_t>& part = parts_[part_[i]];
    for (std::size_t k = begin_[i], end = begin_[i] + count_[i]; k < end; ++k) f(part[k]);
  }

 private:
  std::vector<std::vector<std::uint32_t>> parts_;  // one for each thread
  std::vector<std::uint32_t> part_, count_;
  std::vector<std::size_t> begin_;
};

}  // namespace tandem::particles
