// What ranks exchange of spheres: the state of ghosts, which a neighbour reads in a micro step, and arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/range.hpp"

namespace tandem::dem {

// What a rank exchanges with another one in each micro step.
struct GhostLink {
  unsigned rank = 0;
  Range send;    // part of RankBuffers::send: own spheres that are ghosts there, ascending
  Range ghosts;  // spheres of that rank that are ghosts here
};

// An array that ranks exchange: rank r gets the entries to[r] of `out`, and what rank r sends arrives in the
// entries from[r] of `in`. A rank sends nothing to itself.
struct ExchangedArray {
  std::byte* out = nullptr;
  std::byte* in = nullptr;
  std::size_t entry = 0;  // bytes
  std::vector<Range> to, from;
};
template <class Buffer>
ExchangedArray exchanged(Buffer& out, std::vector<Range> to, Buffer& in, std::vector<Range> from) {
  return {reinterpret_cast<std::byte*>(out.data()), reinterpret_cast<std::byte*>(in.data()),
          sizeof(*out.data()), std::move(to), std::move(from)};
}

// Laws without friction have no spin. An empty base class takes no room; nvcc 13 gives arrays of a struct
// with an empty member that is marked no_unique_address a stride that differs from its sizeof.
template <class Real, bool with_spin>
struct SpinOfGhost {
  Spin<Real> spin;
};
template <class Real>
struct SpinOfGhost<Real, false> {};

// The label of a ghost refers to no walls.
template <class Real, bool with_spin>
struct GhostState : SpinOfGhost<Real, with_spin> {
  PositionRadius<Real> position;
  VelocityKind<Real> velocity;

  TANDEM_HD static GhostState of(const SphereArrays<Real>& s, std::uint32_t side, std::uint32_t i) {
    GhostState ghost;
    ghost.position = s.position[side][i];
    ghost.velocity = s.velocity[side][i];
    ghost.velocity.label = Label::of_kind(ghost.velocity.kind());
    if constexpr (with_spin) ghost.spin = s.spin[side][i];
    return ghost;
  }
  TANDEM_HD void store(const SphereArrays<Real>& s, std::uint32_t side, std::uint32_t i) const {
    s.position[side][i] = position;
    s.velocity[side][i] = velocity;
    if constexpr (with_spin) s.spin[side][i] = this->spin;
  }
};
static_assert(sizeof(GhostState<float, false>) ==
              sizeof(PositionRadius<float>) + sizeof(VelocityKind<float>));

}  // namespace tandem::dem
