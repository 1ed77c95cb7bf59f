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

// Where particles beside walls see them from.
template <class Real>
struct ChooseViewpoints {
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  particles::CentreUnit<Real> centres;
  const std::uint32_t* beside_wall = nullptr;  // the particles
  double ahead = 0;                            // [s]

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = beside_wall[k];
    const particles::FinePart<Real> fine = liquid.fine_part(i);
    arrays.viewpoint[i] = centres.metres(centres.joined(liquid.position[i], fine)) +
                          ahead * particles::velocity_of(liquid.velocity[i], fine);
  }
};

// Finds the sides of closed surfaces on which a particle is when lists are built.
struct FindSides {
  WallsView walls;
  ListView<std::uint32_t> facets;
  const std::uint32_t* beside_wall = nullptr;  // the particles
  const Vec3d* x = nullptr;                    // of each particle [m]
  double reach = 0;                            // of the lists [m]
  std::int8_t* side = nullptr;                 // see WallArrays

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = beside_wall[k], begin = facets.start[i], count = facets.end[i] - begin;
    const auto facet = [this, i, begin](std::uint32_t n) {
      return walls.beside(x[i], facets.entry[begin + n]);
    };
    std::uint32_t known = 0;
    int of_known = 0;
    for (std::uint32_t n = 0; n < count; ++n) {
      const std::uint32_t surface = walls.surface[facets.entry[begin + n]];
      if (surface != 0 && surface != known) {
        known = surface;
        of_known = side_of_surface(x[i], facet, count, known, reach);
      }
      side[begin + n] = static_cast<std::int8_t>(surface != 0 ? of_known : 0);
    }
  }
};

// Marks the entries whose facet has a point within the support, and does not face away as part of a closed
// surface: what a particle would see of such a one is behind others.
struct MarkFacets {
  WallArrays arrays;
  WallsView walls;
  double support = 0;  // [m]

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const Vec3d x = arrays.viewpoint[arrays.particle[entry]];
    const std::uint32_t facet = arrays.facets.entry[entry];
    const int side = arrays.side ? arrays.side[entry] : 0;
    const bool near = (side == 0 || (walls.beside(x, facet).height < 0 ? -1 : 1) == side) &&
                      walls.is_within(support, x, facet);
    arrays.place[entry] = near ? 1 : WallArrays::nowhere;
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
struct PlaceFacet {
  WallArrays arrays;
  WallsView walls;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t place = arrays.place[entry];
    if (place == WallArrays::nowhere) return;
    arrays.near[place] =
        walls.seen_from(arrays.viewpoint[arrays.particle[entry]], arrays.facets.entry[entry]);
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
struct FindHiders {
  WallArrays arrays;
  WallKernel kernel;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry], begin = arrays.facets.start[i],
                        count = arrays.near_count[i];
    const FacetsOfParticle near{arrays.near + begin, static_cast<int>(count)};
    const Hiders hiders = hiders_of(arrays.viewpoint[i], near, static_cast<int>(entry - begin), kernel);
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
template <Sight sight>
struct SeeFacets {
  WallArrays arrays;
  WallKernel kernel;

  TANDEM_HD void operator()(std::uint32_t entry) const {
    const std::uint32_t i = arrays.particle[entry], begin = arrays.facets.start[i];
    const Vec3d x = arrays.viewpoint[i];
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
