// What the lists of a liquid hold: the facets near each particle, and its neighbours.
#pragma once

#include <cstdint>

#include "particles/base/group.hpp"
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

// What fills a list: find(i, group, each) calls each(entry, exists) for the entries of particle i. All
// threads of the group call it together, also for entries that do not exist. by_warps: on a GPU a warp has
// one particle, otherwise a thread.

// The facets with a point within `reach` [m] of particle i.
struct FindFacets {
  static constexpr bool by_warps = false;
  WallsView walls;
  const Vec3d* x = nullptr;  // positions [m]
  double reach = 0;

  template <class Each>
  TANDEM_HD void operator()(std::uint32_t i, particles::OneThread, Each each) const {
    walls.for_near(x[i], reach, [&](std::uint32_t number) {
      each(number, true);
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

// The particles within `reach` [m] of particle i that it sees: no wall is between them.
struct FindNeighbours {
  static constexpr bool by_warps = true;
  particles::CellGrid grid;
  particles::Periods periods;
  const std::uint32_t* cell_start = nullptr;     // of each cell in cell_particle
  const std::uint32_t* cell_particle = nullptr;  // by cell, ascending
  const Vec3d* x = nullptr;                      // positions [m]
  double reach = 0;
  WallsView walls;
  ListView<std::uint32_t> facets;  // near each particle

  template <class Group, class Each>
  TANDEM_HD void operator()(std::uint32_t i, Group group, Each each) const {
    const Vec3d here = x[i];
    const std::int32_t home[3] = {grid.along(here.x, 0), grid.along(here.y, 1), grid.along(here.z, 2)};
    const auto particles_of_cell = [&](std::uint32_t k) -> particles::Run {
      const auto offset = static_cast<std::int32_t>(k);
      std::int32_t c[3] = {home[0] + offset % 3 - 1, home[1] + offset / 3 % 3 - 1, home[2] + offset / 9 - 1};
      particles::Image image = 0;
      if (!grid.exists<true>(c[0], 0, image) || !grid.exists<true>(c[1], 1, image) ||
          !grid.exists<true>(c[2], 2, image))
        return {};
      const std::uint32_t cell = grid.number(c[0], c[1], c[2]);
      return {cell_start[cell], cell_start[cell + 1], image};
    };
    group.for_each(27, particles_of_cell, [&](std::uint32_t n, std::uint32_t note, bool exists) {
      const auto image = static_cast<particles::Image>(note);
      std::uint32_t j = i;
      if (exists) {
        j = cell_particle[n];
        const Vec3d from = here - shift_of(image);
        exists = j != i && norm2(from - x[j]) < reach * reach && !is_hidden(i, here + (x[j] - from));
      }
      each(Neighbour(j, image), exists);
    });
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
