// What the curvature of a wall is to a contact law. A ball is curved; every other wall counts as flat, and a
// flat wall has R* = R.
#pragma once

#include "dem_server/contact/view.hpp"
#include "dem_server/geometry/touch_facet.hpp"

namespace tandem::dem {

// What the law is given of a sphere and the wall that it touches. The wall follows a path that the contact
// does not change, so m* = m.
template <class Real>
struct WallFit {
  Coefficients<Real> k;
  Real r_eff = 0;  // R* [m]
};

template <class Real>
TANDEM_HD WallFit<Real> wall_fit(const View<Real>& view, const WallContact& wall, std::uint32_t kind,
                                 Real radius) {
  const Parameters<Real>& p = view.parameters;
  const std::uint32_t material = view.surface.patches[wall.patch].material;
  const Facet& facet = view.surface.facets[wall.facet];
  if (fetch(&facet.kind) != FacetKind::ball) return {p.wall_flag(kind, radius, material), radius};
  const Real ball = static_cast<Real>(facet.radius());
  // Inside, the normal leads from the surface to the middle.
  const bool inside = dot(wall.point - facet.a, wall.normal) < 0;
  const Real r_eff = inside ? radius_inside(radius, ball) : in_series(radius, ball);
  return {p.with_ball(kind, radius, material, r_eff, radius < ball ? radius : ball), r_eff};
}

}  // namespace tandem::dem
