// What the lists of a liquid hold: the facets near each particle, and its neighbours.
#pragma once

#include <cmath>
#include <cstdint>

#include "particles/base/group.hpp"
#include "particles/grid/cell_grid.hpp"
#include "sph_server/neighbours/apart.hpp"
#include "sph_server/neighbours/neighbour.hpp"
#include "sph_server/neighbours/skin.hpp"
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
// one particle, otherwise a thread; some of its entries may be dropped afterwards, see SeesNeighbour.

// The facets with a point within the reach of particle i.
struct FindFacets {
  static constexpr bool by_warps = false;
  WallsView walls;
  const Vec3d* x = nullptr;  // positions [m]
  Reaches reaches;

  template <class Each>
  TANDEM_HD void operator()(std::uint32_t i, particles::OneThread, Each each) const {
    walls.for_near(x[i], reaches.to_facets(i), [&](std::uint32_t number) {
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
  Reaches reaches;
  float* distance = nullptr;  // of each entry

  // Rounded down, and less than of any facet that is not in the list.
  TANDEM_HD static float at_least(double distance, double margin) {
    return static_cast<float>(distance * (1 - 1e-6) - margin);
  }
  TANDEM_HD void operator()(std::uint32_t entry) const {
    const particles::Facet& f = walls.facet[facets.entry[entry]];
    const std::uint32_t i = particle[entry];
    const double reach = reaches.to_facets(i);
    particles::WallContact contact;
    const bool near = particles::touch_triangle(f, walls.into_body(f.body, x[i]), reach, contact);
    distance[entry] = at_least(near ? contact.gap + reach : reach, walls.margin);
  }
};
struct FindClearance {
  ListView<std::uint32_t> facets;
  const float* distance = nullptr;  // of each entry
  Reaches reaches;
  double margin = 0;           // see MeasureFacets [m]
  float* clearance = nullptr;  // least of the distances of each particle

  TANDEM_HD void operator()(std::uint32_t i) const {
    float least = MeasureFacets::at_least(reaches.to_facets(i), margin);
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

// Positions in the order of cells, so that the threads that compare them load them together. Their radius is
// the skin.
template <class Real>
struct PlaceInCells {
  particles::CentreUnit<Real> centres;
  particles::LengthUnit<Real> unit;
  const float* skin = nullptr;                   // [m]
  const Vec3d* x = nullptr;                      // [m]
  const std::uint32_t* cell_particle = nullptr;  // by cell, ascending
  Position<Real>* position = nullptr;            // of each of these

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = cell_particle[k];
    position[k] = position_of(centres, x[i]);
    position[k].radius = unit.count(static_cast<double>(skin[i]));
  }
};

// From the particles of an image to where they are for their neighbours [m].
TANDEM_HD inline Vec3d shift_of(const particles::Periods& periods, particles::Image image) {
  Vec3d shift;
  for (int a = 0; a < 3; ++a) {
    if (image & particles::image_above(a)) shift[a] = periods.length[a];
    if (image & particles::image_below(a)) shift[a] = -periods.length[a];
  }
  return shift;
}

// The particles that are nearer to particle i than the support and the skins of both.
template <class Real>
struct FindNeighbours {
  static constexpr bool by_warps = true;
  particles::CellGrid grid;
  Vec3f edge;             // of a cell [m]
  std::int32_t span = 1;  // cells that the reach spans, 1 or 2
  Apart<Real> apart;
  particles::CentreUnit<Real> centres;
  particles::Periods periods;
  const std::uint32_t* cell_start = nullptr;     // of each cell in cell_particle
  const std::uint32_t* cell_particle = nullptr;  // by cell, ascending
  const Position<Real>* position = nullptr;      // of each of these
  const Vec3d* x = nullptr;                      // positions [m]
  Reaches reaches;

  template <class Group, class Each>
  TANDEM_HD void operator()(std::uint32_t i, Group group, Each each) const {
    const Row row(*this, i);
    Position<Real> here = position_of(centres, x[i]);
    here.radius = apart.unit.count(static_cast<double>(reaches.skin[i]));
    const Real support = static_cast<Real>(reaches.support);
    const auto across = static_cast<std::uint32_t>(2 * span + 1), runs = runs_of_row();
    group.for_each(
        across * across * runs, [&](std::uint32_t k) { return row.run(k / runs, k % runs); },
        [&](std::uint32_t n, std::uint32_t note, bool exists) {
          const auto image = static_cast<particles::Image>(note);
          std::uint32_t j = i;
          if (exists) {
            j = cell_particle[n];
            const Position<Real> there = position[n];
            const Real apart2 = norm2(apart(here, there, image)),
                       reach = support + apart.unit.metres(here.radius + there.radius);
            exists = j != i && apart2 < reach * reach && !(grid.apart2 > 0 && is_far_away(i, j, image));
          }
          each(Neighbour(j, image), exists);
        });
  }

 private:
  // Rows of cells along x near a particle. Cells are numbered without gaps within blocks of four.
  struct Row {
    const FindNeighbours& find;
    std::int32_t home[3];
    float in_home[3];
    float reach2;  // with a margin for rounding [m2]

    TANDEM_HD Row(const FindNeighbours& f, std::uint32_t i) : find(f) {
      const Vec3d here = f.x[i];
      const double reach = f.reaches.to_neighbours(i);
      reach2 = 1.0001F * static_cast<float>(reach * reach);
      for (int a = 0; a < 3; ++a) {
        home[a] = f.grid.along(here[a], a);
        in_home[a] = static_cast<float>((here[a] - f.grid.origin[a]) * f.grid.inverse_cell[a] - home[a]);
      }
    }
    // Of the particle from the cells at this offset, along one axis [m].
    TANDEM_HD float gap(int axis, std::int32_t offset) const {
      const float low = static_cast<float>(offset), from = in_home[axis];
      return find.edge[axis] * std::fmax(0.0F, std::fmax(low - from, from - (low + 1)));
    }
    // Run `part` of a row: cells that hold particles within the reach.
    TANDEM_HD particles::Run run(std::uint32_t row, std::uint32_t part) const {
      const auto span = find.span, across = 2 * span + 1;
      const std::int32_t dy = static_cast<std::int32_t>(row) % across - span,
                         dz = static_cast<std::int32_t>(row) / across - span;
      const float y = gap(1, dy), z = gap(2, dz), left = reach2 - (y * y + z * z);
      if (left < 0) return {};
      std::int32_t cell_y = home[1] + dy, cell_z = home[2] + dz;
      particles::Image image = 0;
      const particles::CellGrid& grid = find.grid;
      if (!grid.exists<true>(cell_y, 1, image) || !grid.exists<true>(cell_z, 2, image)) return {};
      std::int32_t first = -span, last = span;
      const auto out_of_reach = [&](std::int32_t dx) {
        const float x = gap(0, dx);
        return x * x > left;
      };
      while (first < 0 && out_of_reach(first)) ++first;
      while (last > 0 && out_of_reach(last)) --last;
      first += home[0];
      last += home[0];
      if (!grid.periodic[0]) {
        first = first > 0 ? first : 0;
        last = last < grid.cells[0] - 1 ? last : grid.cells[0] - 1;
      }
      for (; part > 0 && first <= last; --part) first = end_of_run(first, last) + 1;
      if (first > last) return {};
      last = end_of_run(first, last);
      std::int32_t x = first;
      grid.exists<true>(x, 0, image);
      const std::uint32_t number = grid.number(x, cell_y, cell_z);
      return {find.cell_start[number], find.cell_start[number + static_cast<std::uint32_t>(last - first) + 1],
              image};
    }
    // The last cell up to `last` whose number follows without a gap, in the same image.
    TANDEM_HD std::int32_t end_of_run(std::int32_t first, std::int32_t last) const {
      const std::int32_t cells = find.grid.cells[0];
      const std::int32_t shift = first < 0 ? cells : first < cells ? 0 : -cells;
      const std::int32_t of_block = first + 3 - ((first + shift) & 3), of_image = first < 0 ? -1 : cells - 1;
      last = last < of_block ? last : of_block;
      return first >= cells || last < of_image ? last : of_image;
    }
  };

  // In how many runs a row may fall: by the ends of blocks, and of the period.
  TANDEM_HD std::uint32_t runs_of_row() const { return grid.periodic[0] ? 3 : 2; }

  // Positions count modulo a length, and numbers of cells repeat in vast domains.
  TANDEM_HD bool is_far_away(std::uint32_t i, std::uint32_t j, particles::Image image) const {
    const double reach = reaches.to_neighbours(i);
    return norm2(x[j] - x[i] + shift_of(periods, image)) > 2 * reach * reach;
  }
};

// Does a particle beside walls see a neighbour: is no wall between them?
struct SeesNeighbour {
  particles::Periods periods;
  const Vec3d* x = nullptr;  // positions [m]
  WallsView walls;
  ListView<std::uint32_t> facets;    // near each particle
  const float* distance = nullptr;   // see MeasureFacets
  const float* clearance = nullptr;  // see FindClearance

  TANDEM_HD bool operator()(std::uint32_t i, Neighbour neighbour) const {
    const std::uint32_t j = neighbour.index();
    const Vec3d d = x[j] - x[i] + shift_of(periods, neighbour.image());
    const auto apart = static_cast<float>(norm(d));
    if (apart < clearance[i] + clearance[j]) return true;
    return !walls.between(facets.entry + facets.start[i], facets.entry + facets.start[i + 1],
                          distance + facets.start[i], apart, x[i], x[i] + d);
  }
};

}  // namespace tandem::sph
