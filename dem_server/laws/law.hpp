// What a contact law is: a type without state that offers
//
//   static PairConstants<double> constants(const scene::Pair&, const scene::Material& a, const
//   scene::Material& b);
//     the numbers of a pair of materials that the force is computed from
//   ContactForce<Real> operator()(const Contact<Real>&, const Coefficients<Real>&, std::uint32_t law,
//   Vec3<Real>& spring)
//     the force of a contact; `spring`, the tangential spring, is brought to the end of the micro step; `law`
//     is the scene's choice, which GenericLaw alone reads
//
// and, where it is also a variant of its own (engine/contact_variants.def),
//
//   static constexpr bool tangential   it has friction: springs and angular velocities are stored
//   static constexpr bool extended     it is given sizes, masses and adhesion, and rolling acts besides
//
// How long a micro step of a law may be is in common/scene/time_step.hpp, because a scene is checked where
// there is no particle solver.
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
