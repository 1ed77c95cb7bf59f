// What a neighbour reads of a sphere in a micro step.
#pragma once

#include <cstdint>
#include <type_traits>

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"

namespace tandem::dem {

struct NoSpin {};

// The label of a ghost refers to no walls.
template <class Real, bool with_spin>
struct GhostState {
  PositionRadius<Real> position;
  VelocityKind<Real> velocity;
  [[no_unique_address]] std::conditional_t<with_spin, Spin<Real>, NoSpin> spin;

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
    if constexpr (with_spin) s.spin[side][i] = spin;
  }
};

}  // namespace tandem::dem
