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

// Marks the entries whose facet has a point within the support.
template <class Real>
struct MarkFacets {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  WallsView walls;
  particles::CentreUnit<Real> centres;
  double support = 0;  // [m]

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry];
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    arrays.place[entry] = walls.is_within(support, x, arrays.facets.entry[entry]) ? 1 : WallArrays::nowhere;
  }
};

// Gives places, one after the other, to the marked facets of a particle.
struct NumberFacets {
  WallArrays arrays;
  const std::uint32_t* beside_wall = nullptr;  // the particles that have facets in their lists

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = beside_wall[k], begin = arrays.facets.start[i], end = arrays.facets.end[i];
    std::uint32_t place = begin;
    for (std::uint32_t n = begin; n < end; ++n)
      if (arrays.place[n] != WallArrays::nowhere) arrays.place[n] = place++;
    arrays.near_count[i] = place - begin;
  }
};

// The facet of a marked entry in world axes.
template <class Real>
struct PlaceFacet {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  WallsView walls;
  particles::CentreUnit<Real> centres;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t place = arrays.place[entry];
    if (place == WallArrays::nowhere) return;
    const std::uint32_t i = arrays.particle[entry];
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    arrays.near[place] = walls.seen_from(x, arrays.facets.entry[entry]);
  }
};

// Takes the facets of closed surfaces out that face away from a particle.
template <class Real>
struct RemoveBacks {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  const std::uint32_t* surface = nullptr;  // see WallsView
  particles::CentreUnit<Real> centres;
  const std::uint32_t* beside_wall = nullptr;  // see NumberFacets
  double support = 0;                          // [m]

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = beside_wall[k], begin = arrays.facets.start[i], end = arrays.facets.end[i];
    bool any_closed = false;
    for (std::uint32_t n = begin; n < end && !any_closed; ++n)
      any_closed = arrays.place[n] != WallArrays::nowhere && surface[arrays.facets.entry[n]] != 0;
    if (any_closed)
      arrays.near_count[i] =
          without_backs(centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i))),
                        arrays.near + begin, arrays.near_count[i], support);
  }
};

// Does an entry have a facet that its particle may see? They are in the first places.
struct IsNear {
  WallArrays arrays;
  TANDEM_HD bool operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry];
    return entry - arrays.facets.start[i] < arrays.near_count[i];
  }
};

// What hides parts of a facet from a particle.
template <class Real>
struct FindHiders {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  particles::CentreUnit<Real> centres;
  WallKernel kernel;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry], begin = arrays.facets.start[i],
                        count = arrays.near_count[i];
    const FacetsOfParticle near{arrays.near + begin, static_cast<int>(count)};
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    const Hiders hiders = hiders_of(x, near, static_cast<int>(entry - begin), kernel);
    arrays.hiders[entry] = hiders;
    arrays.sight[entry] = hiders == 0 ? Sight::whole : Sight::partial;
  }
};

struct HasSight {
  const Sight* sight = nullptr;
  Sight wanted = Sight::nothing;
  TANDEM_HD bool operator()(std::uint32_t entry) const { return sight[entry] == wanted; }
};

// One facet as one particle sees it: all of it, or what others leave of it. The latter takes far longer.
template <class Real, Sight sight>
struct SeeFacets {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  particles::CentreUnit<Real> centres;
  WallKernel kernel;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry], begin = arrays.facets.start[i];
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    bool complete = true;
    if constexpr (sight == Sight::whole) {
      arrays.seen[entry].integrals = whole_integrals(x, arrays.near[entry], kernel);
    } else {
      const FacetsOfParticle near{arrays.near + begin, static_cast<int>(arrays.near_count[i])};
      arrays.seen[entry].integrals =
          partial_integrals(x, near, static_cast<int>(entry - begin), arrays.hiders[entry], kernel, complete);
    }
    arrays.seen[entry].complete = complete;
  }
};

}  // namespace tandem::sph
