// The arrays of the particles of a liquid, as plain pointers.
#pragma once

#include <cstdint>

#include "particles/state/particles.hpp"
#include "sph_server/equations/pair_terms.hpp"
#include "sph_server/kernel/seen_integrals.hpp"
#include "sph_server/neighbours/find.hpp"

namespace tandem::sph {

// The radius of a position is not used.
template <class Real>
struct LiquidArrays {
  std::uint32_t count = 0;
  // By which others know the particles, whatever their order here (count).
  std::uint32_t* number = nullptr;
  particles::PositionRadius<Real>* position = nullptr;  // (count)
  particles::VelocityKind<Real>* velocity = nullptr;    // (count)
  particles::FinePart<Real>* fine = nullptr;            // (count)
  ParticleState<Real>* state = nullptr;                 // (count)
  double* compression = nullptr;                        // rho/rho0 - 1 [-] (count)
  Vec3d* acceleration[2]{};                             // of this step and of the one before [m/s2] (count)
  double* rate[2]{};                                    // of the compression, likewise [1/s] (count)
  Vec3<Real>* slope = nullptr;     // gradient of the pressure, in this step [Pa/m] (count)
  float* filled = nullptr;         // filled_room(), in this step [-] (count)
  Vec3<Real>* shift = nullptr;     // velocity of the shift [m/s] (count), or null
  ListView<Neighbour> neighbours;  // both particles of a pair list each other

  TANDEM_HD particles::FinePart<Real> fine_part(std::uint32_t i) const {
    if constexpr (particles::has_fine_part<Real>)
      return fine[i];
    else
      return {};
  }
};

// The integrals over what a particle sees of a facet.
struct SeenFacet {
  FacetIntegrals integrals;
  bool complete = true;  // false: so many facets hide parts of it that some are missing
};

// What a particle sees of a facet.
enum class Sight : std::uint8_t { nothing, whole, partial };

// The walls near each particle. Those of particle i begin at facets.start[i].
struct WallArrays {
  ListView<std::uint32_t> facets;           // with a point within the reach when the list was built
  const std::uint32_t* particle = nullptr;  // of each entry of `facets`
  // On which side of its closed surface the particle of an entry is, see side_of_surface(); null where no
  // surface is closed. Particles do not pass walls while a list serves.
  std::int8_t* side = nullptr;
  // Where in `near` the facet of an entry is; `nowhere` if it has no point within the support now, or faces
  // away (entries).
  std::uint32_t* place = nullptr;
  static constexpr std::uint32_t nowhere = ~std::uint32_t{0};
  // The facets that a particle may see: the first near_count[i] from facets.start[i] on.
  std::uint32_t* near_count = nullptr;
  NearFacet* near = nullptr;
  Hiders* hiders = nullptr;  // of each of these facets, where `sight` is partial
  Sight* sight = nullptr;
  SeenFacet* seen = nullptr;
  // Where the facets are seen from: the place of each particle near walls, or where it will be in the middle
  // of the steps that use `seen` [m].
  Vec3d* viewpoint = nullptr;
  Vec3d* by_pressure =
      nullptr;  // acceleration of each particle near walls by pressure, ghosts included [m/s2]
};

// Facets near one particle.
struct FacetsOfParticle {
  const NearFacet* facet = nullptr;  // those of a body follow each other
  int count = 0;

  // One past the last facet of the body that facet k belongs to.
  TANDEM_HD int end_of_body(int k) const {
    const std::uint32_t body = facet[k].body;
    if (facet[count - 1].body == body) return count;
    while (facet[k].body == body) ++k;
    return k;
  }
};

}  // namespace tandem::sph
