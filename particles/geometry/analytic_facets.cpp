#include "particles/geometry/analytic_facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "particles/geometry/touch_facet.hpp"

namespace tandem::particles {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

Vec3d placed(const Pose& pose, Vec3d p) {
  return pose.p_WB + pose.q_WB.rotate(p);
}

Facet plane_facet(const scene::PlaneShape& plane, const Pose& pose, const std::string& where) {
  const double length = norm(plane.normal);
  if (!(length > 0) || !std::isfinite(length)) {
    throw Error(ErrorCode::scene, "the plane's normal has no length", where, "give a unit vector");
  }
  Facet facet;
  facet.kind = FacetKind::plane;
  facet.a = placed(pose, plane.point);
  facet.normal = normalized(pose.q_WB.rotate(plane.normal));
  return facet;
}

// A facet about the z axis of the wall's frame; its centre is at height z.
Facet round_facet(FacetKind kind, double radius, double half_height, double z, const Pose& pose) {
  Facet facet;
  facet.kind = kind;
  facet.a = placed(pose, {0, 0, z});
  facet.b = {radius, half_height, 0};
  facet.c = pose.q_WB.rotate(Vec3d{1, 0, 0});
  facet.normal = pose.q_WB.rotate(Vec3d{0, 0, 1});
  return facet;
}

std::vector<Facet> cylinder_facets(const scene::CylinderShape& cylinder, const Pose& pose) {
  const double half = 0.5 * cylinder.height.value_or(endless);
  std::vector<Facet> facets{round_facet(FacetKind::cylinder, cylinder.radius, half, 0, pose)};
  const auto close = [&](const char* end, double z) {
    if (std::find(cylinder.open.begin(), cylinder.open.end(), end) == cylinder.open.end())
      facets.push_back(round_facet(FacetKind::disc, cylinder.radius, 0, z, pose));
  };
  if (!cylinder.height) return facets;
  close("-z", -half);
  close("+z", half);
  return facets;
}

}  // namespace

bool is_analytic(const decltype(scene::Wall::shape)& shape) {
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&shape)) return !cylinder->segments;
  return std::holds_alternative<scene::PlaneShape>(shape) ||
         std::holds_alternative<scene::SphereShape>(shape);
}

std::vector<Facet> analytic_facets(const scene::Wall& wall, const std::string& where) {
  if (const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape))
    return {plane_facet(*plane, wall.pose, where)};
  if (const auto* sphere = std::get_if<scene::SphereShape>(&wall.shape))
    return {round_facet(FacetKind::ball, sphere->radius, 0, 0, wall.pose)};
  return cylinder_facets(std::get<scene::CylinderShape>(wall.shape), wall.pose);
}

Facet ball_facet(Vec3d centre, double radius) {
  return round_facet(FacetKind::ball, radius, 0, 0, {centre, {}});
}

double smaller_radius(const Facet& facet, double radius) {
  return facet.kind == FacetKind::ball ? std::min(facet.radius(), radius) : radius;
}

double extent_of(const Facet& analytic) {
  if (analytic.kind == FacetKind::plane) return endless;
  if (analytic.kind == FacetKind::ball) return norm(analytic.a) + analytic.radius();
  const AboutAxis origin(analytic, {});
  return std::hypot(std::abs(origin.along) + analytic.half_height(), origin.rho + analytic.radius());
}

}  // namespace tandem::particles
