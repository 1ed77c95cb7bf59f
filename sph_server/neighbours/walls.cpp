#include "sph_server/neighbours/walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/error.hpp"
#include "particles/geometry/facet_grid.hpp"
#include "sph_server/neighbours/closed_surfaces.hpp"

namespace tandem::sph {
namespace {

constexpr particles::GridBudget wall_grid_budget{std::size_t{1} << 22, std::size_t{1} << 26};

// On which sides of the plane of f the other facet has corners, see NearFacet.
std::uint8_t sides_reached(const particles::Facet& f, const particles::Facet& other, double tolerance) {
  std::uint8_t sides = 0;
  for (const Vec3d& corner : {other.a, other.b, other.c}) {
    const double height = dot(corner - f.a, f.normal);
    if (height > tolerance) sides |= 1;
    if (height < -tolerance) sides |= 2;
  }
  return sides;
}

// Of the smallest box along the axes.
std::array<Vec3d, 8> corners_around(const std::vector<Vec3d>& points) {
  if (points.empty()) return {};
  Vec3d end[2] = {points.front(), points.front()};
  for (const Vec3d& x : points)
    for (int a = 0; a < 3; ++a) {
      end[0][a] = std::min(end[0][a], x[a]);
      end[1][a] = std::max(end[1][a], x[a]);
    }
  std::array<Vec3d, 8> corners;
  for (std::size_t k = 0; k < corners.size(); ++k)
    corners[k] = {end[k & 1].x, end[k >> 1 & 1].y, end[k >> 2].z};
  return corners;
}

}  // namespace

Walls::Walls(const std::vector<TriangleMesh>& meshes, double reach, const std::vector<bool>& slip)
    : margin_(edge_margin * reach) {
  cell_start_.push_back(0);
  for (std::size_t body = 0; body < meshes.size(); ++body) {
    const TriangleMesh& mesh = meshes[body];
    if (const auto bad = degenerate_triangles(mesh); !bad.empty())
      throw Error(ErrorCode::scene, "triangle " + std::to_string(bad.front()) + " has no area",
                  "walls of body " + std::to_string(body), "remove it from the mesh");
    const auto first = static_cast<std::uint32_t>(facets_.size());
    for (const auto& t : mesh.triangles) {
      facets_.push_back(
          particles::triangle_facet(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
      facets_.back().body = static_cast<std::uint32_t>(body);
    }
    grids_.push_back(particles::make_facet_grid(std::span(facets_).subspan(first), first, reach,
                                                wall_grid_budget, cell_start_, cell_facet_));
    poses_.push_back({{}, Mat3d::identity(), {}, {}});
    slip_.push_back(body < slip.size() && slip[body] ? 1 : 0);
    add_closed_surfaces(std::span(facets_).subspan(first), reach, surface_);
    corners_.push_back(corners_around(mesh.vertices));
  }
  // A point sees only facets of its cell.
  beyond_.assign(facets_.size(), 0);
  for (std::size_t cell = 0; cell + 1 < cell_start_.size(); ++cell)
    for (std::uint32_t i = cell_start_[cell]; i < cell_start_[cell + 1]; ++i) {
      std::uint8_t& sides = beyond_[cell_facet_[i]];
      for (std::uint32_t k = cell_start_[cell]; k < cell_start_[cell + 1] && sides != 3; ++k)
        sides |= sides_reached(facets_[cell_facet_[i]], facets_[cell_facet_[k]], 1e-7 * reach);
    }
  any_closed_ = std::any_of(surface_.begin(), surface_.end(), [](std::uint32_t s) { return s != 0; });
}

WallsView Walls::view() const {
  return {facets_.data(), grids_.data(),  cell_start_.data(), cell_facet_.data(), poses_.data(),
          slip_.data(),   beyond_.data(), surface_.data(),    bodies(),           margin_};
}

void Walls::find(Vec3d x, double radius, NearWalls& found) const {
  found.facet.clear();
  const WallsView walls = view();
  walls.for_near(x, radius, [&](std::uint32_t number) {
    found.facet.push_back(walls.seen_from(x, number));
    return true;
  });
  found.count = static_cast<int>(found.facet.size());
}
void Walls::find_seen(Vec3d x, double radius, NearWalls& found) const {
  found.facet.clear();
  const WallsView walls = view();
  walls.for_near(x, radius, [&](std::uint32_t number) {
    if (walls.is_within(radius, x, number)) found.facet.push_back(walls.seen_from(x, number));
    return true;
  });
  const auto all = static_cast<std::uint32_t>(found.facet.size());
  found.count = static_cast<int>(without_backs(x, found.facet.data(), all, radius));
}

double Walls::moved_from(const std::vector<particles::BodyPose>& poses_then) const {
  double most = 0;
  for (std::uint32_t body = 0; body < bodies(); ++body) {
    const particles::BodyPose &then = poses_then[body], &now = poses_[body];
    // The way is linear in the place, and so none in the box is longer than the longest of a corner.
    for (const Vec3d& corner : corners_[body])
      most = std::max(most, norm((now.p - then.p) + (now.R * corner - then.R * corner)));
  }
  return most;
}

double Walls::largest_speed(Vec3d frame) const {
  double most = 0;
  for (std::uint32_t body = 0; body < bodies(); ++body)
    for (const Vec3d& corner : corners_[body])
      most = std::max(most, norm(poses_[body].v + cross(poses_[body].w, poses_[body].R * corner) - frame));
  return most;
}

}  // namespace tandem::sph
