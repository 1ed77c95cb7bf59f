// Limits of the micro step, in one place for the check of a given step and for the solver's own choice. The
// time that limits the step of one contact is that of its law (law.hpp).
//
// A sphere in a packing has up to twelve contacts, which halves the limit of one; damping reduces it further.
// Hence a step above 0.4 of this time is refused, and the solver chooses 0.2 of it.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::dem {

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

// Duration of the shortest collision, without damping, that a sphere of `radius` made of `material` can have
// with an equal one of any material with which it can be in contact, at this closing speed. A collision with
// a wall takes longer; one with a smaller sphere is counted for that sphere [s].
double collision_time(const scene::Dem& dem, MaterialId material, double radius, double speed);

// The time that limits the micro step for spheres of `radius` made of `material`, over all possible contacts
// [s].
double critical_time(const scene::Dem& dem, MaterialId material, double radius);

// The shortest over all groups that move and whose radius the scene gives [s]; groups from files count with
// their `radius` or, without one, not at all. Infinite where no group counts.
double critical_time(const scene::Dem& dem);

// Throw Error{scene} where the scene gives a micro step that is too long for the spheres of its groups, or
// for those of a file that a group names and that gives their radii [m].
void check_micro_step(const scene::Dem& dem, const std::string& origin);
void check_micro_step(const scene::Dem& dem, const std::string& origin, MaterialId material,
                      const std::vector<double>& radii, const std::string& file);

}  // namespace tandem::dem
