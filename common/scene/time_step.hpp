// Limits of the micro step, in one place for the check of a given step and for the solver's own choice.
//
// Hertz laws: the Rayleigh time of a sphere, the time in which a surface wave crosses half of it,
//     T_R = pi r sqrt(rho / G) / (0.1631 nu + 0.8766),   G = E / (2 (1 + nu)).
// Law `paper` has stiffnesses of its own, without E and nu. Its time is the stability limit of central
// differences for one contact, linearised at the overlap 0.05 r (with larger overlaps a scene is too soft for
// its loads):
//     T = 2 / omega (sqrt(1 + zeta^2) - zeta),   omega^2 = 3/2 k sqrt(0.05 r) / m,
//     zeta = c / (2 sqrt(3/2 k m)),
// the shorter of the normal one (k_n, c_n, m of the pair) and the tangential one (k_t, c_t, 2/7 m, because
// the sphere also rotates). zeta does not depend on the overlap. Law `hooke` likewise, with omega^2 = k / m
// and zeta = c / (2 sqrt(k m)) from the restitution.
//
// A sphere in a packing has up to twelve contacts, which halves the limit of one; damping reduces it further.
// Hence a step above 0.4 of this time is refused, and the solver chooses 0.2 of it.
#pragma once

#include "common/scene/model.hpp"

namespace tandem::scene {

inline constexpr double largest_step_share = 0.4;    // of critical_time [-]
inline constexpr double automatic_step_share = 0.2;  // of critical_time [-]

// A collision that is resolved by few steps has a wrong rebound speed: by 1 % with 6 steps, 0.5 % with 8,
// 4e-4 with 20 (leapfrog on Hertz's law without damping, any phase; a test). Longer steps than the first
// share cause a warning, and the automatic step respects the second share.
inline constexpr double largest_collision_share = 1.0 / 6;     // of collision_time [-]
inline constexpr double automatic_collision_share = 1.0 / 20;  // of collision_time [-]

// Very soft spheres and walls with prescribed motion may move so far in one step that they pass an obstacle
// without contact. A warning is given for steps in which the smallest sphere and an obstacle approach by more
// than the first share of its radius; the automatic step respects the second share at the expected speed,
// which two spheres may both have.
inline constexpr double largest_travel_share = 1.0 / 2;    // of the smallest radius [-]
inline constexpr double automatic_travel_share = 1.0 / 4;  // of the smallest radius [-]

// T_R [s]; radius [m].
double rayleigh_time(double radius, const Material& material);

// Whether the constants of a pair, not E and nu, give the stiffness.
bool has_own_stiffness(ContactLaw law);

// T of a contact of law `paper` [s]; `mass` is the reduced mass of the two bodies [kg].
double contact_time(double radius, double mass, const Pair& pair);
// T of a contact of law `hooke` [s].
double hooke_time(double mass, const Pair& pair);
// c / sqrt(m* k) of law `hooke` for this restitution e [-]: -2 ln e / sqrt(ln^2 e + pi^2), and 2 for e = 0.
double hooke_damping(double restitution);

// Duration of the shortest collision, without damping, that a sphere of `radius` made of `material` can have
// with an equal one of any material with which it can be in contact, at this closing speed [m/s]:
//     Hertz and law `paper`:  T = 2.943 (5 m* / (4 k))^(2/5) v^(-1/5),  k = 4/3 E* sqrt(R*) or k_n
//     law `hooke`:            T = pi sqrt(m* / k_n)
// A collision with a wall takes longer; one with a smaller sphere is counted for that sphere [s].
double collision_time(const Dem& dem, MaterialId material, double radius, double speed);

// The time that limits the micro step for spheres of `radius` made of `material`, over all possible contacts
// [s].
double critical_time(const Dem& dem, MaterialId material, double radius);

// The shortest over all groups that move and whose radius the scene gives [s]; groups from files count with
// their `radius` or, without one, not at all: the solver, which has the radii, uses the function above.
// Infinite where no group counts.
double critical_time(const Dem& dem);

}  // namespace tandem::scene
