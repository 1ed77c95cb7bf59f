// Which facets of a body are closed surfaces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "particles/geometry/facet.hpp"

namespace tandem::sph {

// Appends for each facet of a body the number of its closed surface, or 0 if it belongs to none. Numbers
// continue those in `surface`. Facets that join at edges are a closed surface if each edge belongs to two of
// them, which are oriented alike, and if no two of them intersect: from each side of it, points see one side
// of its facets only. Corners are one where they are less than some 1e-7 of `reach` [m] apart.
void add_closed_surfaces(std::span<const particles::Facet> facets, double reach,
                         std::vector<std::uint32_t>& surface);

}  // namespace tandem::sph
