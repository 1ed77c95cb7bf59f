// Walls of bodies as plain arrays, for host and device: facets near a point, and what is between two points.
#pragma once

#include <cmath>
#include <cstdint>

#include "particles/geometry/facet.hpp"
#include "particles/geometry/path.hpp"
#include "sph_server/neighbours/near_facet.hpp"

namespace tandem::sph {

// Is every point of the triangle further than `radius` from x, seen across its plane or across one edge?
TANDEM_HD inline bool is_far(const particles::Facet& f, Vec3d x, double radius) {
  if (std::fabs(dot(x - f.a, f.normal)) >= radius) return true;
  const Vec3d corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k) {
    const Vec3d edge = corner[k < 2 ? k + 1 : 0] - corner[k], outward = cross(edge, f.normal);
    const double beyond = dot(x - corner[k], outward);
    if (beyond >= 0 && beyond * beyond >= radius * radius * norm2(edge)) return true;
  }
  return false;
}

// A line is stopped by a facet also this much beyond its edges [reach of the walls]. So facets that nearly
// join are tight, and for particles of a lattice beside an edge the answer does not depend on rounding.
inline constexpr double edge_margin = 3e-5;

// Does the segment from x to y cross the triangle, or its plane less than `margin` [m] beyond an edge?
TANDEM_HD inline bool crosses(const particles::Facet& f, Vec3d x, Vec3d y, double margin) {
  const double from = dot(x - f.a, f.normal), to = dot(y - f.a, f.normal);
  if ((from > 0 && to > 0) || (from < 0 && to < 0) || from == to) return false;
  const Vec3d at = x + (from / (from - to)) * (y - x), corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k) {
    const Vec3d edge = corner[k < 2 ? k + 1 : 0] - corner[k];
    const double inside = dot(at - corner[k], cross(f.normal, edge));  // times the length of the edge
    if (inside < 0 && inside * inside > margin * margin * norm2(edge)) return false;
  }
  return true;
}

struct WallsView {
  const particles::Facet* facet = nullptr;
  const particles::FacetGrid* grid = nullptr;  // (bodies)
  const std::uint32_t* cell_start = nullptr;   // see particles::Surface
  const std::uint32_t* cell_facet = nullptr;
  const particles::BodyPose* pose = nullptr;  // (bodies)
  const std::uint8_t* slip = nullptr;         // 1: of a body without friction (bodies)
  const std::uint8_t* beyond = nullptr;       // see NearFacet (facets)
  const std::uint32_t* surface = nullptr;     // see NearFacet (facets)
  std::uint32_t bodies = 0;
  double margin = 0;  // of crosses() [m]

  TANDEM_HD Vec3d into_body(std::uint32_t body, Vec3d x) const {
    return pose[body].R.transpose_times(x - pose[body].p);
  }
  TANDEM_HD NearFacet in_world(std::uint32_t number) const {
    const particles::Facet& f = facet[number];
    const particles::BodyPose& at = pose[f.body];
    NearFacet near;
    near.a = at.p + at.R * f.a;
    near.b = at.p + at.R * f.b;
    near.c = at.p + at.R * f.c;
    near.normal = at.R * f.normal;
    near.body = f.body;
    near.surface = surface[number];
    near.beyond = beyond[number];
    return near;
  }
  // Has the facet a point less than `radius` [m] from x?
  TANDEM_HD bool is_within(double radius, Vec3d x, std::uint32_t number) const {
    particles::WallContact contact;
    return particles::touch_triangle(facet[number], into_body(facet[number].body, x), radius, contact);
  }
  // Without the cone.
  TANDEM_HD NearFacet beside(Vec3d x, std::uint32_t number) const {
    NearFacet near = in_world(number);
    near.height = dot(x - near.a, near.normal);
    return near;
  }
  TANDEM_HD NearFacet seen_from(Vec3d x, std::uint32_t number) const {
    NearFacet near = beside(x, number);
    near.cone = ViewCone::of(x, near.a, near.b, near.c);
    return near;
  }

  // Calls each(number) for the facets that may have a point within `radius` <= reach of x, in ascending order
  // of body and facet, until it returns false.
  template <class Each>
  TANDEM_HD void for_near(Vec3d x, double radius, Each each) const {
    for (std::uint32_t body = 0; body < bodies; ++body) {
      const Vec3d in_body = into_body(body, x);
      const particles::NearFacets listed = near(body, in_body);
      for (int k = 0; k < listed.count; ++k)
        if (!is_far(facet[listed[k]], in_body, radius) && !each(listed[k])) return;
    }
  }

  // False: no facet of the body has a point within the reach of x.
  TANDEM_HD bool may_be_near(std::uint32_t body, Vec3d x) const {
    return near(body, into_body(body, x)).count > 0;
  }

  // Is a facet between two points, less than the reach apart? The answer for (x, y) is that for (y, x).
  TANDEM_HD bool between(Vec3d x, Vec3d y) const {
    put_in_order(x, y);
    for (std::uint32_t body = 0; body < bodies; ++body) {
      const Vec3d from = into_body(body, x), to = into_body(body, y);
      const particles::NearFacets listed = near(body, from);
      for (int k = 0; k < listed.count; ++k)
        if (crosses(facet[listed[k]], from, to, margin)) return true;
    }
    return false;
  }
  // The same for one facet.
  TANDEM_HD bool between(std::uint32_t number, Vec3d x, Vec3d y) const {
    const float at_x = 0;
    return between(&number, &number + 1, &at_x, 1, x, y);
  }
  // The same for the facets numbered by `number` to `end`, of which those of a body follow each other and
  // those are between x and y at most that are not farther than `apart` from x.
  TANDEM_HD bool between(const std::uint32_t* number, const std::uint32_t* end, const float* distance,
                         float apart, Vec3d x, Vec3d y) const {
    put_in_order(x, y);
    Vec3d from, to;
    for (std::uint32_t body = bodies; number != end; ++number, ++distance) {
      if (*distance > apart) continue;
      const particles::Facet& f = facet[*number];
      if (f.body != body) {
        body = f.body;
        from = into_body(body, x);
        to = into_body(body, y);
      }
      if (crosses(f, from, to, margin)) return true;
    }
    return false;
  }
  // Did a point that moved from `then` to `now` pass a facet, while the bodies moved from these poses to
  // theirs?
  TANDEM_HD bool passed(std::uint32_t number, const particles::BodyPose* poses_then, Vec3d then,
                        Vec3d now) const {
    const particles::Facet& f = facet[number];
    const particles::BodyPose& at = poses_then[f.body];
    return crosses(f, at.R.transpose_times(then - at.p), into_body(f.body, now), margin);
  }

 private:
  // in_body: a point in the frame of the body [m].
  TANDEM_HD particles::NearFacets near(std::uint32_t body, Vec3d in_body) const {
    return particles::near_facets(grid[body], cell_start, cell_facet, in_body);
  }
  TANDEM_HD static void put_in_order(Vec3d& x, Vec3d& y) {
    if (x.x != y.x ? x.x < y.x : x.y != y.y ? x.y < y.y : x.z < y.z) return;
    const Vec3d first = x;
    x = y;
    y = first;
  }
};

}  // namespace tandem::sph
