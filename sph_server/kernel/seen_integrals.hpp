// The integrals over what a point sees of each facet near it.
#pragma once

#include <cmath>
#include <cstdint>

#include "sph_server/kernel/facet_integrals.hpp"
#include "sph_server/kernel/visible_part.hpp"

namespace tandem::sph {

// Facets: has `most`. Facet: has corners a, b, c, a unit `normal`, `body` and `beyond`, see
// neighbours/walls_view.hpp. Facets: `count` of them in `facet`. overflow becomes true where a facet falls
// into too many parts.
template <class Facets>
TANDEM_HD FacetIntegrals seen_integrals(Vec3d x, const Facets& near, int k, const WallKernel& kernel,
                                        bool& overflow) {
  const auto& f = near.facet[k];
  const Vec3d corner[3] = {f.a, f.b, f.c};
  const double tolerance = 1e-6 * kernel.R;
  Polygon whole;
  whole.count = 3;
  for (int n = 0; n < 3; ++n) whole.corner[n] = corner[n];
  const auto may_hide = [&](const auto& g) {
    const double height = dot(x - g.a, g.normal);
    if (std::fabs(height) <= tolerance) return false;
    if (g.body == f.body && (g.beyond & (height > 0 ? 2 : 1)) == 0) return false;
    const Vec3d away = height > 0 ? -g.normal : g.normal;
    return reaches_beyond(whole, g.a, away, tolerance);
  };
  const auto shadow = [&](int n) {
    const auto& g = near.facet[n];
    return Shadow::of(x, g.a, g.b, g.c, g.normal, tolerance);
  };
  particles::UninitialisedArray<std::uint8_t, Facets::most> hider;
  static_assert(Facets::most <= 256);
  int hiders = 0;
  for (int n = 0; n < near.count; ++n)
    if (n != k && may_hide(near.facet[n]) && shadow(n).meets(whole))
      hider[hiders++] = static_cast<std::uint8_t>(n);
  if (hiders == 0) return facet_integrals(x, corner, 3, f.normal, kernel);
  const double height = dot(x - f.a, f.normal);
  FacetIntegrals sum;
  const bool whole_sum = for_visible_parts(
      whole, f.normal, x, kernel.R, hiders, [&](int n) { return shadow(hider[n]); },
      [&](const Polygon& part) {
        sum += facet_integrals(x, part.corner.data(), part.count, f.normal, height, kernel);
      });
  overflow = overflow || !whole_sum;
  return sum;
}

}  // namespace tandem::sph
