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

// What fills a list: find(i, each) calls each(entry) for the entries of particle i.

// The facets with a point within `reach` [m] of particle i.
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

// A GPU keeps arrays in registers where loops over them are unrolled, and where what is rarely needed has
// registers of its own.
#if defined(__CUDACC__)
#define TANDEM_UNROLLED _Pragma("unroll")
#define TANDEM_RARE __noinline__
#else
#define TANDEM_UNROLLED
#define TANDEM_RARE
#endif

// Some particles of one cell, whose neighbours are found together.
struct CellMates {
  static constexpr std::uint32_t most = 4;
  std::uint32_t count = 0;
  const std::uint32_t* first = nullptr;  // of the particles
  std::uint32_t particle[most];
  Vec3d x[most];          // [m]
  float clearance[most];  // see FindClearance [m]
  std::int32_t cell[3];
  Vec3f low, high;  // of the box around them, from the corner of the cell [cells]
};

// The particles within `reach` [m] of particle i that it sees: no wall is between them.
struct FindNeighbours {
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

  template <class Each>
  TANDEM_HD void operator()(std::uint32_t i, Each each) const {
    CellMates one;
    one.first = &i;
    one.count = 1;
    add(0, one);
    of_mates(one, particles::OneThread{}, [&](std::uint32_t, Neighbour entry, bool exists) {
      if (exists) each(entry);
    });
  }

  // The particles of one cell from number `first` of cell_particle on.
  TANDEM_HD CellMates mates_from(std::uint32_t first) const {
    CellMates mates;
    mates.first = cell_particle + first;
    mates.count = mates_at(first);
    TANDEM_UNROLLED
    for (std::uint32_t k = 0; k < CellMates::most; ++k)
      if (k < mates.count) add(k, mates);
    return mates;
  }
  TANDEM_HD std::uint32_t mates_at(std::uint32_t first) const {
    const std::uint32_t left = cell_start[cell_of(cell_particle[first]) + 1] - first;
    return left < CellMates::most ? left : CellMates::most;
  }
  // Do mates begin at this number of cell_particle?
  TANDEM_HD bool begins_mates(std::uint32_t number) const {
    return (number - cell_start[cell_of(cell_particle[number])]) % CellMates::most == 0;
  }

  // Calls each(k, entry, exists) for the entries of mate k. All threads of the group call it together, also
  // for entries that do not exist.
  template <class Group, class Each>
  TANDEM_HD void of_mates(const CellMates& mates, Group group, Each each) const {
    const auto across = static_cast<std::uint32_t>(2 * span + 1);
    const auto particles_of_cell = [&](std::uint32_t k) -> particles::Run {
      const std::uint32_t row = span == 2 ? k / 5 : k / 3, layer = span == 2 ? k / 25 : k / 9;
      const std::int32_t offset[3] = {static_cast<std::int32_t>(k - row * across) - span,
                                      static_cast<std::int32_t>(row - layer * across) - span,
                                      static_cast<std::int32_t>(layer) - span};
      if (is_out_of_reach(mates, offset)) return {};
      std::int32_t c[3] = {mates.cell[0] + offset[0], mates.cell[1] + offset[1], mates.cell[2] + offset[2]};
      particles::Image image = 0;
      if (!grid.exists<true>(c[0], 0, image) || !grid.exists<true>(c[1], 1, image) ||
          !grid.exists<true>(c[2], 2, image))
        return {};
      const std::uint32_t cell = grid.number(c[0], c[1], c[2]);
      return {cell_start[cell], cell_start[cell + 1], image};
    };
    group.for_each(across * across * across, particles_of_cell,
                   [&](std::uint32_t n, std::uint32_t note, bool exists) {
                     const auto image = static_cast<particles::Image>(note);
                     const std::uint32_t j = cell_particle[n];
                     const Vec3d there = x[j], shift = shift_of(image);
                     const float clear = clearance[j];
                     std::uint32_t near = 0, doubtful = 0;  // a bit for each mate
                     TANDEM_UNROLLED
                     for (std::uint32_t k = 0; k < CellMates::most; ++k) {
                       if (k >= mates.count || !exists) continue;
                       const double apart2 = norm2(mates.x[k] - shift - there);
                       if (!(apart2 < reach * reach) || j == mates.particle[k]) continue;
                       near |= 1u << k;
                       if (!(distance_of(apart2) < mates.clearance[k] + clear)) doubtful |= 1u << k;
                     }
                     for (std::uint32_t k = 0; doubtful >> k != 0; ++k)
                       if ((doubtful >> k & 1) != 0 && is_hidden(mates.first[k], there, shift))
                         near &= ~(1u << k);
                     TANDEM_UNROLLED
                     for (std::uint32_t k = 0; k < CellMates::most; ++k)
                       if (k < mates.count) each(k, Neighbour(j, image), (near >> k & 1) != 0);
                   });
  }

 private:
  TANDEM_HD std::uint32_t cell_of(std::uint32_t i) const { return CellOfParticle{grid, x}(i); }
  // Mate k.
  TANDEM_HD void add(std::uint32_t k, CellMates& mates) const {
    const std::uint32_t i = mates.first[k];
    const Vec3d here = x[i];
    const std::int32_t cell[3] = {grid.along(here.x, 0), grid.along(here.y, 1), grid.along(here.z, 2)};
    for (int a = 0; a < 3; ++a) {
      const auto in_cell = static_cast<float>((here[a] - grid.origin[a]) * grid.inverse_cell[a] - cell[a]);
      mates.cell[a] = cell[a];
      mates.low[a] = k > 0 ? std::fmin(mates.low[a], in_cell) : in_cell;
      mates.high[a] = k > 0 ? std::fmax(mates.high[a], in_cell) : in_cell;
    }
    mates.particle[k] = i;
    mates.clearance[k] = clearance[i];
    mates.x[k] = here;
  }
  // Is every point of a cell out of reach of the box around the mates? With a margin for rounding.
  TANDEM_HD bool is_out_of_reach(const CellMates& mates, const std::int32_t (&offset)[3]) const {
    float distance2 = 0;
    for (int a = 0; a < 3; ++a) {
      const float low = static_cast<float>(offset[a]);
      const float gap = edge[a] * std::fmax(0.0F, std::fmax(low - mates.high[a], mates.low[a] - (low + 1)));
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
  TANDEM_HD static float distance_of(double square) { return std::sqrt(static_cast<float>(square)); }
  // Is particle i hidden from one at `there`, or from its image that is shifted?
  TANDEM_HD TANDEM_RARE bool is_hidden(std::uint32_t i, Vec3d there, Vec3d shift) const {
    const Vec3d to = there - (x[i] - shift);
    const std::uint32_t begin = facets.start[i], end = facets.start[i + 1];
    return walls.between(facets.entry + begin, facets.entry + end, distance + begin, distance_of(norm2(to)),
                         x[i], x[i] + to);
  }
};

}  // namespace tandem::sph
