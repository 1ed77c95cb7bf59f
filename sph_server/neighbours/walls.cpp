#include "sph_server/neighbours/walls.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "particles/geometry/facet_grid.hpp"

namespace tandem::sph {
namespace {

constexpr dem::GridBudget wall_grid_budget{std::size_t{1} << 22, std::size_t{1} << 26};

Vec3d into_body(const dem::BodyPose& pose, Vec3d x) {
  return pose.R.transpose_times(x - pose.p);
}

// Is every point of the triangle further than `radius` from x, seen across its plane or across one edge?
bool is_far(const dem::Facet& f, Vec3d x, double radius) {
  if (std::fabs(dot(x - f.a, f.normal)) >= radius) return true;
  const Vec3d corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k) {
    const Vec3d edge = corner[(k + 1) % 3] - corner[k], outward = cross(edge, f.normal);
    if (dot(x - corner[k], outward) >= radius * norm(edge)) return true;
  }
  return false;
}

// Does the segment from x to y cross the triangle? Its edges belong to it, so that a closed mesh is tight.
bool crosses(const dem::Facet& f, Vec3d x, Vec3d y) {
  const double from = dot(x - f.a, f.normal), to = dot(y - f.a, f.normal);
  if ((from > 0 && to > 0) || (from < 0 && to < 0) || from == to) return false;
  const Vec3d at = x + (from / (from - to)) * (y - x), corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k) {
    const Vec3d edge = corner[(k + 1) % 3] - corner[k];
    if (dot(at - corner[k], cross(f.normal, edge)) < -1e-12 * norm2(edge)) return false;
  }
  return true;
}

bool in_order(Vec3d x, Vec3d y) {
  if (x.x != y.x) return x.x < y.x;
  if (x.y != y.y) return x.y < y.y;
  return x.z < y.z;
}

}  // namespace

Walls::Walls(const std::vector<TriangleMesh>& meshes, double reach) {
  cell_start_.push_back(0);
  for (std::size_t body = 0; body < meshes.size(); ++body) {
    const TriangleMesh& mesh = meshes[body];
    if (const auto bad = degenerate_triangles(mesh); !bad.empty())
      throw Error(ErrorCode::scene, "triangle " + std::to_string(bad.front()) + " has no area",
                  "walls of body " + std::to_string(body), "remove it from the mesh");
    const auto first = static_cast<std::uint32_t>(facets_.size());
    for (const auto& t : mesh.triangles) {
      facets_.push_back(dem::triangle_facet(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
      facets_.back().body = static_cast<std::uint32_t>(body);
    }
    grids_.push_back(dem::make_facet_grid(std::span(facets_).subspan(first), first, reach, wall_grid_budget,
                                          cell_start_, cell_facet_));
    poses_.push_back({{}, Mat3d::identity(), {}, {}});
    double extent = 0;
    for (const Vec3d& vertex : mesh.vertices) extent = std::max(extent, norm(vertex));
    extent_.push_back(extent);
  }
}

void Walls::find(Vec3d x, double radius, NearWalls& found) const {
  found.count = 0;
  found.overflow = false;
  for (std::uint32_t body = 0; body < bodies(); ++body) {
    const dem::BodyPose& pose = poses_[body];
    const Vec3d in_body = into_body(pose, x);
    const dem::NearFacets near =
        dem::near_facets(grids_[body], cell_start_.data(), cell_facet_.data(), in_body);
    for (int k = 0; k < near.count; ++k) {
      const dem::Facet& f = facets_[near[k]];
      if (is_far(f, in_body, radius)) continue;
      if (found.count == NearWalls::most) {
        found.overflow = true;
        return;
      }
      found.facet[found.count++] = {pose.p + pose.R * f.a, pose.p + pose.R * f.b, pose.p + pose.R * f.c,
                                    pose.R * f.normal, body};
    }
  }
}

bool Walls::between(Vec3d x, Vec3d y) const {
  if (!in_order(x, y)) std::swap(x, y);
  for (std::uint32_t body = 0; body < bodies(); ++body) {
    const Vec3d from = into_body(poses_[body], x), to = into_body(poses_[body], y);
    const dem::NearFacets near = dem::near_facets(grids_[body], cell_start_.data(), cell_facet_.data(), from);
    for (int k = 0; k < near.count; ++k)
      if (crosses(facets_[near[k]], from, to)) return true;
  }
  return false;
}

bool Walls::passed(const std::vector<dem::BodyPose>& poses_then, Vec3d then, Vec3d now) const {
  for (std::uint32_t body = 0; body < bodies(); ++body) {
    const Vec3d from = into_body(poses_then[body], then), to = into_body(poses_[body], now);
    const dem::NearFacets near = dem::near_facets(grids_[body], cell_start_.data(), cell_facet_.data(), from);
    for (int k = 0; k < near.count; ++k)
      if (crosses(facets_[near[k]], from, to)) return true;
  }
  return false;
}

double Walls::moved_from(const std::vector<dem::BodyPose>& poses_then) const {
  double most = 0;
  for (std::uint32_t body = 0; body < bodies(); ++body) {
    const dem::BodyPose &then = poses_then[body], &now = poses_[body];
    double turned2 = 0;
    for (int k = 0; k < 3; ++k) turned2 += norm2(now.R.row[k] - then.R.row[k]);
    most = std::max(most, norm(now.p - then.p) + std::sqrt(turned2) * extent_[body]);
  }
  return most;
}

}  // namespace tandem::sph
