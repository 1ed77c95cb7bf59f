// The facets near one point, as the point sees them.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "particles/base/elementary.hpp"
#include "particles/geometry/touch_facet.hpp"
#include "sph_server/kernel/view_cone.hpp"

namespace tandem::sph {

// A facet near a point x, in world axes.
struct NearFacet {
  Vec3d a, b, c, normal;  // [m], [-]
  double height = 0;      // of x above its plane [m]
  ViewCone cone;          // from x
  std::uint32_t body = 0;
  std::uint32_t surface = 0;  // closed surface to which it belongs; 0: none, see closed_surfaces.hpp
  // Facets of the same body reach beyond the plane, on the side of the normal (bit 0) or the other (bit 1).
  std::uint8_t beyond = 0;
  bool faces_away = false;  // from x, which does not see it; see turn_away_backs()
};

// The share of the directions in the plane of a triangle that lead into it from a point on it: 1 inside, 1/2
// on an edge.
TANDEM_HD inline double share_around(const NearFacet& f, Vec3d point, double distance) {
  const Vec3d corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k) {
    if (point.x != corner[k].x || point.y != corner[k].y || point.z != corner[k].z) continue;
    const Vec3d u = corner[k < 2 ? k + 1 : 0] - corner[k], v = corner[k > 0 ? k - 1 : 2] - corner[k];
    return particles::angle_of(norm(cross(u, v)), dot(u, v)) / (2 * std::numbers::pi);
  }
  return distance <= std::fabs(f.height) * (1 + 1e-9) ? 1 : 0.5;
}

// On which side of a closed surface is x: 1 that of the normals, -1 the other? By the angle-weighted normal
// at the nearest point [BaerentzenAanaes2005]. 0 where all facets of the surface face x, and where the answer
// could depend on rounding. facet(k): one of `count` facets near x, with those of other surfaces.
template <class FacetAt>
TANDEM_HD int side_of_surface(Vec3d x, FacetAt facet, std::uint32_t count, std::uint32_t surface, double R) {
  bool front = false, back = false;
  double nearest = R;
  particles::WallContact contact;
  const auto touches = [&](const NearFacet& f, double range) {
    return particles::touch_triangle(particles::Facet{f.a, f.b, f.c, f.normal}, x, range, contact);
  };
  for (std::uint32_t k = 0; k < count; ++k) {
    const NearFacet& f = facet(k);
    if (f.surface != surface) continue;
    (f.height < 0 ? back : front) = true;
    if (std::fabs(f.height) < nearest && touches(f, nearest)) nearest += contact.gap;
  }
  if (!(front && back)) return 0;
  // Facets whose nearest points are that of the surface, as those around a corner.
  const double range = nearest + 1e-9 * R;
  double along = 0, weight = 0, highest = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const NearFacet& f = facet(k);
    if (f.surface != surface || std::fabs(f.height) > range || !touches(f, range)) continue;
    const double share = share_around(f, contact.point, contact.gap + range);
    along += share * f.height;
    weight += share;
    if (std::fabs(f.height) > std::fabs(highest)) highest = f.height;
  }
  if (!(std::fabs(along) > 0.01 * weight * nearest) || along * highest < 0) return 0;
  return along > 0 ? 1 : -1;
}

// Marks the facets of closed surfaces that face away from x. What x would see of them is behind facets that
// face x.
TANDEM_HD inline void turn_away_backs(Vec3d x, NearFacet* facet, std::uint32_t count, double R) {
  std::uint32_t known = 0;
  int side = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    NearFacet& f = facet[k];
    if (f.surface == 0) continue;
    if (f.surface != known) {
      known = f.surface;
      side = side_of_surface(
          x, [facet](std::uint32_t n) -> const NearFacet& { return facet[n]; }, count, known, R);
    }
    f.faces_away = side != 0 && (f.height < 0 ? -1 : 1) != side;
  }
}

// Removes them and returns how many facets are left, in their order.
TANDEM_HD inline std::uint32_t without_backs(Vec3d x, NearFacet* facet, std::uint32_t count, double R) {
  turn_away_backs(x, facet, count, R);
  std::uint32_t kept = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (facet[k].faces_away) continue;
    if (kept != k) facet[kept] = facet[k];
    ++kept;
  }
  return kept;
}

}  // namespace tandem::sph
