// What the lists of a liquid hold: the facets near each particle, and its neighbours.
#pragma once

#include <cmath>
#include <cstdint>

#include "particles/base/group.hpp"
#include "particles/grid/cell_grid.hpp"
#include "sph_server/neighbours/neighbour.hpp"
#include "sph_server/neighbours/walls_view.hpp"

namespace tandem::sph {

// A list of entries for each particle: those of particle i are entry[start[i]] to entry[end[i] - 1]. Where
// the entries of one particle are may differ from run to run, their order does not.
template <class Entry>
struct ListView {
  const std::uint32_t* start = nullptr;  // (particles)
  const std::uint32_t* end = nullptr;    // (particles)
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

// How far the particles of a list of facets are from them, at least [m]: what is between two points is not
// farther from either than they are apart. A facet stops lines also `walls.margin` beyond its edges.
struct MeasureFacets {
  WallsView walls;
  ListView<std::uint32_t> facets;
  const std::uint32_t* particle = nullptr;  // of each entry
  const Vec3d* x = nullptr;                 // [m]
  double reach = 0;                         // [m]
  float* distance = nullptr;                // of each entry

  // Rounded down, and less than of any facet that is not in the list.
  TANDEM_HD static float at_least(double distance, double margin) {
    return static_cast<float>(distance * (1 - 1e-6) - margin);
  }
  TANDEM_HD void operator()(std::uint32_t entry) const {
    const particles::Facet& f = walls.facet[facets.entry[entry]];
    particles::WallContact contact;
    const bool near =
        particles::touch_triangle(f, walls.into_body(f.body, x[particle[entry]]), reach, contact);
    distance[entry] = at_least(near ? contact.gap + reach : reach, walls.margin);
  }
};
struct FindClearance {
  ListView<std::uint32_t> facets;
  const float* distance = nullptr;  // of each entry
  float most = 0;                   // that of a particle without facets
  float* clearance = nullptr;       // least of the distances of each particle

  TANDEM_HD void operator()(std::uint32_t i) const {
    float least = most;
    for (std::uint32_t n = facets.start[i]; n < facets.start[i + 1]; ++n)
      least = std::fmin(least, distance[n]);
    clearance[i] = least;
  }
};

// Cells that the reach spans: smaller cells have fewer particles that are out of reach, and cost memory.
inline std::int32_t span_of(const scene::Box& domain, double reach) {
  constexpr double most = 8e6;  // cells
  const Vec3d size = domain.max - domain.min;
  return size.x * size.y * size.z < most * std::pow(reach / 2, 3) ? 2 : 1;
}

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
  Vec3f edge;             // of a cell [reach]
  std::int32_t span = 1;  // cells that the reach spans, 1 or 2
  particles::Periods periods;
  const std::uint32_t* cell_start = nullptr;     // of each cell in cell_particle
  const std::uint32_t* cell_particle = nullptr;  // by cell, ascending
  const Vec3d* x = nullptr;                      // positions [m]
  double reach = 0;
  WallsView walls;
  ListView<std::uint32_t> facets;    // near each particle
  const float* distance = nullptr;   // see MeasureFacets
  const float* clearance = nullptr;  // see FindClearance

  template <class Group, class Each>
  TANDEM_HD void operator()(std::uint32_t i, Group group, Each each) const {
    const Vec3d here = x[i];
    const std::int32_t home[3] = {grid.along(here.x, 0), grid.along(here.y, 1), grid.along(here.z, 2)};
    const Vec3d in_cells{(here.x - grid.origin.x) * grid.inverse_cell.x,
                         (here.y - grid.origin.y) * grid.inverse_cell.y,
                         (here.z - grid.origin.z) * grid.inverse_cell.z};
    const Vec3f in_home{static_cast<float>(in_cells.x - home[0]), static_cast<float>(in_cells.y - home[1]),
                        static_cast<float>(in_cells.z - home[2])};
    const auto across = static_cast<std::uint32_t>(2 * span + 1);
    const auto particles_of_cell = [&](std::uint32_t k) -> particles::Run {
      const std::uint32_t row = span == 2 ? k / 5 : k / 3, layer = span == 2 ? k / 25 : k / 9;
      const std::int32_t offset[3] = {static_cast<std::int32_t>(k - row * across) - span,
                                      static_cast<std::int32_t>(row - layer * across) - span,
                                      static_cast<std::int32_t>(layer) - span};
      if (is_out_of_reach(in_home, offset)) return {};
      std::int32_t c[3] = {home[0] + offset[0], home[1] + offset[1], home[2] + offset[2]};
      particles::Image image = 0;
      if (!grid.exists<true>(c[0], 0, image) || !grid.exists<true>(c[1], 1, image) ||
          !grid.exists<true>(c[2], 2, image))
        return {};
      const std::uint32_t cell = grid.number(c[0], c[1], c[2]);
      return {cell_start[cell], cell_start[cell + 1], image};
    };
    group.for_each(
        across * across * across, particles_of_cell, [&](std::uint32_t n, std::uint32_t note, bool exists) {
          const auto image = static_cast<particles::Image>(note);
          std::uint32_t j = i;
          if (exists) {
            j = cell_particle[n];
            const Vec3d from = here - shift_of(image);
            const double apart2 = norm2(from - x[j]);
            exists = j != i && apart2 < reach * reach && !is_hidden(i, j, apart2, here + (x[j] - from));
          }
          each(Neighbour(j, image), exists);
        });
  }

 private:
  // Is every point of a cell out of reach of a point in the home cell [cells]? With a margin for rounding.
  TANDEM_HD bool is_out_of_reach(Vec3f from, const std::int32_t (&offset)[3]) const {
    float distance2 = 0;
    for (int a = 0; a < 3; ++a) {
      const float low = static_cast<float>(offset[a]);
      const float gap = edge[a] * std::fmax(0.0F, std::fmax(low - from[a], from[a] - (low + 1)));
      distance2 += gap * gap;
    }
    return distance2 > 1.0001F;
  }
  TANDEM_HD Vec3d shift_of(particles::Image image) const {
    Vec3d shift;
    for (int a = 0; a < 3; ++a) {
      if (image & particles::image_above(a)) shift[a] = periods.length[a];
      if (image & particles::image_below(a)) shift[a] = -periods.length[a];
    }
    return shift;
  }
  // y: where particle j is, or the image of it that i sees.
  TANDEM_HD bool is_hidden(std::uint32_t i, std::uint32_t j, double apart2, Vec3d y) const {
    const float apart = std::sqrt(static_cast<float>(apart2));
    if (apart < clearance[i] + clearance[j]) return false;
    return walls.between(facets.entry + facets.start[i], facets.entry + facets.start[i + 1],
                         distance + facets.start[i], apart, x[i], y);
  }
};

}  // namespace tandem::sph
