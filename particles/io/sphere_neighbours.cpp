#include "particles/io/sphere_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace tandem::particles {

SphereLevels::SphereLevels(const PackedSpheres& spheres) {
  std::map<int, std::vector<std::uint32_t>> octaves;
  for (std::size_t i = 0; i < spheres.position.size(); ++i)
    octaves[std::ilogb(spheres.radius[i])].push_back(static_cast<std::uint32_t>(i));
  for (auto& [octave, members] : octaves) {
    Level& level = levels_.emplace_back();
    Vec3d high = level.low = spheres.position[members.front()];
    for (const std::uint32_t i : members) {
      level.largest = std::max(level.largest, spheres.radius[i]);
      for (int a = 0; a < 3; ++a) {
        level.low[a] = std::min(level.low[a], spheres.position[i][a]);
        high[a] = std::max(high[a], spheres.position[i][a]);
      }
    }
    level.edge = 2 * level.largest;
    const auto cells = [&] {
      double all = 1;
      for (int a = 0; a < 3; ++a) {
        const double along = std::floor((high[a] - level.low[a]) / level.edge) + 1;
        level.cells[a] = static_cast<std::int64_t>(std::min(along, 1e9));
        all *= along;
      }
      return all;
    };
    // Few spheres in a large room get larger cells.
    while (cells() > 4.0 * static_cast<double>(members.size()) + 1000) level.edge *= 1.25;
    const auto cell_of = [&](std::uint32_t i) {
      std::int64_t at[3];
      for (int a = 0; a < 3; ++a)
        at[a] = std::min(static_cast<std::int64_t>((spheres.position[i][a] - level.low[a]) / level.edge),
                         level.cells[a] - 1);
      return static_cast<std::size_t>((at[2] * level.cells[1] + at[1]) * level.cells[0] + at[0]);
    };
    const auto count = static_cast<std::size_t>(level.cells[0] * level.cells[1] * level.cells[2]);
    level.start.assign(count + 1, 0);
    for (const std::uint32_t i : members) ++level.start[cell_of(i) + 1];
    for (std::size_t c = 0; c < count; ++c) level.start[c + 1] += level.start[c];
    level.spheres.resize(members.size());
    std::vector<std::uint32_t> next(level.start.begin(), level.start.end() - 1);
    for (const std::uint32_t i : members) level.spheres[next[cell_of(i)]++] = i;
  }
}

void NeighbourList::build(const PackedSpheres& spheres, double margin, ThreadPool& pool) {
  const SphereLevels levels(spheres);
  parts_.resize(pool.size());
  part_.resize(spheres.moving);
  count_.resize(spheres.moving);
  begin_.resize(spheres.moving);
  for_ranges(pool, spheres.moving, [&](unsigned thread, std::size_t first, std::size_t end) {
    std::vector<std::uint32_t>& part = parts_[thread];
    part.clear();
    for (std::size_t i = first; i < end; ++i) {
      part_[i] = thread;
      begin_[i] = part.size();
      const Vec3d p = spheres.position[i];
      levels.for_near(p, spheres.radius[i], margin, i, [&](std::uint32_t j) {
        const double reach = (1 + margin) * (spheres.radius[i] + spheres.radius[j]);
        if (norm2(spheres.position[j] - p) < reach * reach) part.push_back(j);
      });
      count_[i] = static_cast<std::uint32_t>(part.size() - begin_[i]);
      // Sums over neighbours have one order, whatever the cells were.
      std::sort(part.begin() + static_cast<std::ptrdiff_t>(begin_[i]), part.end());
    }
  });
}

}  // namespace tandem::particles
