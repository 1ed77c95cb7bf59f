// The sites of a lattice fill, for the check that a fill has room for its count, and for the solver.
//
// Cubic:     sites at spacing s along x, y and z.
// Hexagonal: close-packed layers (ABAB, hcp). Rows along x at distance s sqrt(3)/2, every second row shifted
// by s/2; layers at distance s sqrt(2/3), every second layer shifted by (s/2, s sqrt(3)/6).
// The first site is a radius away from three faces of the box. Sites are counted along x, then y, then z, so
// that a fill with a count is filled from the bottom.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// Number of sites at which a sphere of `radius` is inside the box. A double, because a small spacing gives
// more than 2^64.
double lattice_capacity(const LatticeFill& fill, double radius);

// The first `count` sites [m] (count x 3); count <= lattice_capacity(fill, radius).
std::vector<Vec3d> lattice_sites(const LatticeFill& fill, double radius, std::uint64_t count);

}  // namespace tandem::scene
