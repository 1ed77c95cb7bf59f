// What particles see of the walls near them, before the sums over walls.
#pragma once

#include <cstdint>

#include "particles/state/centre.hpp"
#include "sph_server/kernel/seen_integrals.hpp"
#include "sph_server/kernel/wall_kernel.hpp"
#include "sph_server/step/arrays.hpp"

namespace tandem::sph {

// Names the particle of each entry of the list of facets.
struct NameParticles {
  ListView<std::uint32_t> facets;
  std::uint32_t* particle = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const {
    for (std::uint32_t n = facets.start[i]; n < facets.end[i]; ++n) particle[n] = i;
  }
};

// The facet of an entry in world axes, if it has a point within the support.
template <class Real>
struct PlaceFacet {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  WallsView walls;
  particles::CentreUnit<Real> centres;
  double support = 0;  // [m]

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry], number = arrays.facets.entry[entry];
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    const bool is_near = walls.is_within(support, x, number);
    arrays.in_support[entry] = is_near;
    if (is_near) arrays.near[entry] = walls.seen_from(x, number);
  }
};

// The facets that particle i may see, one after the other.
template <class Real>
struct SelectFacets {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  const std::uint32_t* surface = nullptr;  // see WallsView
  particles::CentreUnit<Real> centres;
  double support = 0;  // [m]

  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t begin = arrays.facets.start[i], end = arrays.facets.end[i];
    std::uint32_t count = 0;
    bool any_closed = false;
    for (std::uint32_t n = begin; n < end; ++n) {
      if (arrays.in_support[n] == 0) continue;
      any_closed = any_closed || surface[arrays.facets.entry[n]] != 0;
      if (begin + count != n) arrays.near[begin + count] = arrays.near[n];
      ++count;
    }
    if (any_closed)
      count = without_backs(centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i))),
                            arrays.near + begin, count, support);
    arrays.near_count[i] = count;
  }
};

// One facet as one particle sees it.
template <class Real>
struct SeeFacets {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  particles::CentreUnit<Real> centres;
  WallKernel kernel;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry], begin = arrays.facets.start[i],
                        count = arrays.near_count[i], k = entry - begin;
    if (k >= count) return;
    const FacetsOfParticle near{arrays.near + begin, static_cast<int>(count)};
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    bool complete = true;
    arrays.seen[entry].integrals = seen_integrals(x, near, static_cast<int>(k), kernel, complete);
    arrays.seen[entry].complete = complete;
  }
};

}  // namespace tandem::sph
