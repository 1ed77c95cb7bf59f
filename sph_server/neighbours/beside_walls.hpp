// The particles that have facets in their lists, and those of these facets that may meet those of another
// body.
#pragma once

#include <cstdint>

#include "sph_server/neighbours/find.hpp"

namespace tandem::sph {

// How many are marked.
struct Marked {
  std::uint32_t count = 0;
  TANDEM_HD void add(const Marked& b) { count += b.count; }
};

struct MarkBesideWalls {
  ListView<std::uint32_t> facets;
  std::uint32_t* mark = nullptr;  // 1: beside a wall (particles)
  TANDEM_HD void operator()(std::uint32_t i, Marked& marked) const {
    mark[i] = facets.start[i] < facets.end[i] ? 1 : 0;
    marked.count += mark[i];
  }
};

// The marked numbers, ascending.
struct ListMarked {
  const std::uint32_t* before = nullptr;  // how many marks precede each number
  std::uint32_t* number = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (before[i + 1] != before[i]) number[before[i]] = i;
  }
};

// Particles beside walls in classes of how many facets they have, so that threads side by side have as much
// to do: a table of one row per class, of which MarkClass marks one entry for each particle.
struct FacetClasses {
  static constexpr std::uint32_t classes = 8;
  ListView<std::uint32_t> facets;
  const std::uint32_t* beside_wall = nullptr;  // ascending
  std::uint32_t particles = 0;                 // as many

  // Where particle k of `beside_wall` has its mark.
  TANDEM_HD std::uint32_t place(std::uint32_t k) const {
    const std::uint32_t i = beside_wall[k], count = facets.end[i] - facets.start[i];
    const std::uint32_t row = count <= 4 ? count - 1 : count <= 6 ? 4 : count <= 10 ? 5 : count <= 18 ? 6 : 7;
    return row * particles + k;
  }
};
struct MarkClass {
  FacetClasses of;
  std::uint32_t* table = nullptr;  // (classes x particles), zeros
  TANDEM_HD void operator()(std::uint32_t k) const { table[of.place(k)] = 1; }
};
struct ListByClass {
  FacetClasses of;
  const std::uint32_t* before = nullptr;  // how many marks of the table precede each entry
  std::uint32_t* particle = nullptr;
  TANDEM_HD void operator()(std::uint32_t k) const { particle[before[of.place(k)]] = of.beside_wall[k]; }
};

// The facets of particles that have those of several bodies in their lists.
struct MarkBetweenBodies {
  ListView<std::uint32_t> facets;           // those of a body follow each other
  const std::uint32_t* particle = nullptr;  // of each entry of `facets`
  WallsView walls;
  std::uint32_t* mark = nullptr;  // (entries of facets)
  TANDEM_HD void operator()(std::uint32_t entry, Marked& marked) const {
    const std::uint32_t i = particle[entry], first = facets.entry[facets.start[i]],
                        last = facets.entry[facets.end[i] - 1];
    mark[entry] = walls.facet[first].body != walls.facet[last].body ? 1 : 0;
    marked.count += mark[entry];
  }
};

}  // namespace tandem::sph
