// A contact law is a type without state that offers
//
//   static PairConstants<double> constants(const scene::Pair&, const scene::Material& a,
//                                          const scene::Material& b);
//     the constants of a pair of materials from which the force is computed
//   ContactForce<Real> operator()(const Contact<Real>&, const Coefficients<Real>&, std::uint32_t law,
//                                 Vec3<Real>& spring)
//     the force of a contact. It advances `spring`, the tangential spring, to the end of the micro step.
//     `law` is the scene's choice; only GenericLaw reads it.
//
// and, where it is also a variant of its own (engine/contact_variants.def),
//
//   static constexpr bool tangential   it has friction: springs and angular velocities are stored
//   static constexpr bool extended     it receives sizes, masses and adhesion, and the loop adds rolling
//
// common/scene/time_step.hpp holds the longest stable micro step of each law, because scenes are also checked
// by programs without a particle solver.
#pragma once

#include <concepts>
#include <cstdint>

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/contact.hpp"

namespace tandem::dem {

template <class L>
concept ContactLaw = std::is_empty_v<L> &&
    requires(const L law, const Contact<double>& contact, const Coefficients<double>& k, Vec3<double>& spring,
             const scene::Pair& pair, const scene::Material& m) {
  { L::constants(pair, m, m) } -> std::same_as<PairConstants<double>>;
  { law(contact, k, std::uint32_t{}, spring) } -> std::same_as<ContactForce<double>>;
};

}  // namespace tandem::dem
