// What the lists of a liquid hold: the facets near each particle, and its neighbours.
#pragma once

#include <cstdint>

#include "particles/grid/cell_grid.hpp"
#include "sph_server/neighbours/neighbour.hpp"
#include "sph_server/neighbours/walls_view.hpp"

namespace tandem::sph {

// A list of entries for each particle: those of particle i are entry[start[i]] to entry[start[i + 1] - 1].
template <class Entry>
struct ListView {
  const std::uint32_t* start = nullptr;  // (particles + 1)
  const Entry* entry = nullptr;
};

// Calls each(number) for the facets with a point within `reach` [m] of particle i.
struct FindFacets {
  WallsView walls;
  const Vec3d* x = nullptr;  // positions [m]
  double reach = 0;

  template <class Each>
  TANDEM_HD void operator()(std::uint32_t i, Each each) const {
    walls.for_near(x[i], reach, [&](std::uint32_t number) {
      each(number);
      return true;
    });
  }
};

struct CellOfParticle {
  particles::CellGrid grid;
  const Vec3d* x = nullptr;  // [m]

  TANDEM_HD std::uint32_t operator()(std::uint32_t i) const {
    return grid.number(grid.along(x[i].x, 0), grid.along(x[i].y, 1), grid.along(x[i].z, 2));
  }
};

// Calls each(neighbour) for the particles within `reach` [m] of particle i that it sees: no wall is between
// them.
struct FindNeighbours {
  particles::CellGrid grid;
  particles::Periods periods;
  const std::uint32_t* cell_start = nullptr;     // of each cell in cell_particle
  const std::uint32_t* cell_particle = nullptr;  // by cell, ascending
  const Vec3d* x = nullptr;                      // positions [m]
  double reach = 0;
  WallsView walls;
  ListView<std::uint32_t> facets;  // near each particle

  template <class Each>
  TANDEM_HD void operator()(std::uint32_t i, Each each) const {
    const std::int32_t home[3] = {grid.along(x[i].x, 0), grid.along(x[i].y, 1), grid.along(x[i].z, 2)};
    for (int k = 0; k < 27; ++k) {
      std::int32_t c[3] = {home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1};
      particles::Image image = 0;
      if (!grid.exists<true>(c[0], 0, image) || !grid.exists<true>(c[1], 1, image) ||
          !grid.exists<true>(c[2], 2, image))
        continue;
      const std::uint32_t cell = grid.number(c[0], c[1], c[2]);
      const Vec3d from = x[i] - shift_of(image);
      for (std::uint32_t n = cell_start[cell]; n < cell_start[cell + 1]; ++n) {
        const std::uint32_t j = cell_particle[n];
        if (j == i || !(norm2(from - x[j]) < reach * reach)) continue;
        if (!is_hidden(i, x[i] + (x[j] - from))) each(Neighbour(j, image));
      }
    }
  }

 private:
  TANDEM_HD Vec3d shift_of(particles::Image image) const {
    Vec3d shift;
    for (int a = 0; a < 3; ++a) {
      if (image & particles::image_above(a)) shift[a] = periods.length[a];
      if (image & particles::image_below(a)) shift[a] = -periods.length[a];
    }
    return shift;
  }
  TANDEM_HD bool is_hidden(std::uint32_t i, Vec3d y) const {
    for (std::uint32_t n = facets.start[i]; n < facets.start[i + 1]; ++n)
      if (walls.between(facets.entry[n], x[i], y)) return true;
    return false;
  }
};

}  // namespace tandem::sph
