// Radii of a packing's spheres.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// Sets the smallest and the largest radius of a group from its sizes.
void set_radius_limits(ParticleGroup& group);

// The radii of a group, in a fixed order. They are the quantiles of the distribution at equal steps of the
// number, not random numbers, so that the masses of lists and of sieve classes are met within one sphere
// each. `volume`: of all spheres together [m3], met within half of the largest sphere; `count`: their number.
std::vector<double> radii_of_volume(const ParticleGroup& group, double volume);
std::vector<double> radii_of_count(const ParticleGroup& group, std::uint64_t count);

// Volume of all spheres together [m3].
double volume_of(const std::vector<double>& radii);

}  // namespace tandem::scene
