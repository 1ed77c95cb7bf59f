#include "sph_server/neighbours/neighbour_list.hpp"

#include <algorithm>

namespace tandem::sph {
namespace {

// Particles by cells: those of cell c are order[start[c]] to order[start[c + 1] - 1], ascending.
struct SortedCells {
  std::vector<std::uint32_t> start, order;
};

SortedCells sort(const particles::CellGrid& grid, std::span<const Vec3d> x) {
  SortedCells s;
  s.start.assign(std::size_t{grid.total} + 1, 0);
  std::vector<std::uint32_t> cell(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    cell[i] = grid.number(grid.along(x[i].x, 0), grid.along(x[i].y, 1), grid.along(x[i].z, 2));
    ++s.start[cell[i] + 1];
  }
  for (std::uint32_t c = 0; c < grid.total; ++c) s.start[c + 1] += s.start[c];
  std::vector<std::uint32_t> next(s.start.begin(), s.start.end() - 1);
  s.order.resize(x.size());
  for (std::uint32_t i = 0; i < x.size(); ++i) s.order[next[cell[i]]++] = i;
  return s;
}

Vec3d shift_of(particles::Image image, const particles::Periods& periods) {
  Vec3d shift;
  for (int a = 0; a < 3; ++a) {
    if (image & particles::image_above(a)) shift[a] = periods.length[a];
    if (image & particles::image_below(a)) shift[a] = -periods.length[a];
  }
  return shift;
}

// Calls each(j, image, x_j - x_i) for the neighbours j of i.
template <class Each>
void search(const particles::CellGrid& grid, const particles::Periods& periods, const SortedCells& cells,
            std::span<const Vec3d> x, double reach, std::uint32_t i, Each each) {
  const std::int32_t home[3] = {grid.along(x[i].x, 0), grid.along(x[i].y, 1), grid.along(x[i].z, 2)};
  for (int k = 0; k < 27; ++k) {
    std::int32_t c[3] = {home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1};
    particles::Image image = 0;
    if (!grid.exists<true>(c[0], 0, image) || !grid.exists<true>(c[1], 1, image) ||
        !grid.exists<true>(c[2], 2, image))
      continue;
    const std::uint32_t cell = grid.number(c[0], c[1], c[2]);
    const Vec3d from = x[i] - shift_of(image, periods);
    for (std::uint32_t n = cells.start[cell]; n < cells.start[cell + 1]; ++n) {
      const std::uint32_t j = cells.order[n];
      if (j != i && norm2(from - x[j]) < reach * reach) each(j, image, x[j] - from);
    }
  }
}

}  // namespace

void build_list(const particles::CellGrid& grid, const particles::Periods& periods, std::span<const Vec3d> x,
                double reach, const Walls& walls, particles::ThreadPool& pool, NeighbourList& list) {
  const SortedCells cells = sort(grid, x);
  const std::size_t n = x.size();
  // Each thread lists a range of particles; the ranges are joined in order.
  std::vector<std::vector<Neighbour>> found(pool.size());
  list.start.assign(n + 1, 0);
  pool.run([&](unsigned thread) {
    const std::size_t begin = n * thread / pool.size(), end = n * (thread + 1) / pool.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t before = found[thread].size();
      NearWalls near;
      walls.find(x[i], reach, near);
      search(grid, periods, cells, x, reach, static_cast<std::uint32_t>(i),
             [&](std::uint32_t j, particles::Image image, Vec3d d) {
               if (near.count > 0 && walls.between(x[i], x[i] + d)) return;
               found[thread].emplace_back(j, image);
             });
      list.start[i + 1] = static_cast<std::uint32_t>(found[thread].size() - before);
    }
  });
  for (std::size_t i = 0; i < n; ++i) list.start[i + 1] += list.start[i];
  list.neighbour.clear();
  for (const auto& part : found) list.neighbour.insert(list.neighbour.end(), part.begin(), part.end());
}

}  // namespace tandem::sph
