// Builds the grid that finds a body's facets near a point.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "particles/geometry/facet.hpp"

namespace tandem::particles {

// Limits for one grid; cells become larger until it keeps them.
struct GridBudget {
  std::size_t cells = 0;
  std::size_t entries = 0;  // facet indices listed in all cells
};

// Grid over triangles and balls of one body, whose indices start at `first_facet`. Appends to the two lists;
// the last entry of `cell_start` is the end of the last cell. Each facet is listed in all cells with a point
// at most `reach` away from it, and possibly in a few more. Error{resource} when the facets alone exceed the
// budget.
FacetGrid make_facet_grid(std::span<const Facet> facets, std::uint32_t first_facet, double reach,
                          GridBudget budget, std::vector<std::uint32_t>& cell_start,
                          std::vector<std::uint32_t>& cell_facet);

}  // namespace tandem::particles
