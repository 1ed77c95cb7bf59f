// Coefficients of a contact with a wall. Ball walls are curved; every other wall counts as flat, with R* = R.
#pragma once

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/touch_facet.hpp"

namespace tandem::dem {

// Input of the law for a sphere in contact with a wall. The contact does not change the wall's motion, so m*
// = m.
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
  if (fetch(&facet.kind) != FacetKind::ball) return {p.with_wall(kind, radius, material), radius};
  const Real ball = static_cast<Real>(facet.radius());
  // Inside the ball the normal points from the surface to the centre.
  const bool inside = dot(wall.point - facet.a, wall.normal) < 0;
  const Real r_eff = inside ? radius_inside(radius, ball) : in_series(radius, ball);
  return {p.with_ball(kind, radius, material, r_eff, radius < ball ? radius : ball), r_eff};
}

}  // namespace tandem::dem
