// A contact law is a type without state that offers
//
//   static PairConstants<double> constants(const scene::Pair&, const scene::Material& a,
//                                          const scene::Material& b);
//     the constants of a pair of materials from which the force is computed
//   static constexpr bool sized
//     whether its coefficients depend on sizes and masses (PairConstants)
//   static double critical_time(const scene::Pair&, const scene::Material& own, double radius)
//     the time that limits the micro step for the contact of a sphere of `own` with an equal one; a contact
//     with a lighter sphere is counted for that sphere (step_limits.hpp) [s]
//   static constexpr const char* critical_time_name
//     what that time is called
//   static double collision_time(const scene::Pair&, const scene::Material& own,
//                                const scene::Material& other, double radius, double speed)
//     duration of the collision, without damping, of a sphere of `own` with one of `other` of the same size
//     and mass at this closing speed [s]
//   static constexpr StiffnessKey stiffness
//     what a user enlarges where overlaps are too large
//   ContactForce<Real> operator()(const Contact<Real>&, const Coefficients<Real>&, std::uint32_t law,
//                                 Vec3<Real>& spring)
//     the force of a contact. It advances `spring`, the tangential spring, to the end of the micro step.
//     `law` is the scene's choice; only GenericLaw reads it.
//
// and, where it is also a variant of its own (engine/contact_variants.def),
//
//   static constexpr bool tangential   it has friction: springs and angular velocities are stored
//   static constexpr bool extended     it receives sizes, masses and adhesion, and the loop adds rolling
//   static constexpr bool belts        the variant runs scenes with walls whose surfaces move along
//   themselves
#pragma once

#include <concepts>
#include <cstdint>

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/contact.hpp"
#include "dem_server/laws/durations.hpp"

namespace tandem::dem {

template <class L>
concept ContactLaw = std::is_empty_v<L> &&
    requires(const L law, const Contact<double>& contact, const Coefficients<double>& k, Vec3<double>& spring,
             const scene::Pair& pair, const scene::Material& m) {
  { L::constants(pair, m, m) } -> std::same_as<PairConstants<double>>;
  { L::sized } -> std::convertible_to<bool>;
  { L::critical_time(pair, m, double{}) } -> std::same_as<double>;
  { L::critical_time_name } -> std::convertible_to<const char*>;
  { L::collision_time(pair, m, m, double{}, double{}) } -> std::same_as<double>;
  { L::stiffness } -> std::same_as<const StiffnessKey&>;
  { law(contact, k, std::uint32_t{}, spring) } -> std::same_as<ContactForce<double>>;
};

}  // namespace tandem::dem
