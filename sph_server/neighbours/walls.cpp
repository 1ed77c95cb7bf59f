#include "sph_server/neighbours/walls.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"
#include "particles/geometry/facet_grid.hpp"

namespace tandem::sph {
namespace {

constexpr dem::GridBudget wall_grid_budget{std::size_t{1} << 22, std::size_t{1} << 26};

}  // namespace

Walls::Walls(const std::vector<TriangleMesh>& meshes, double reach, const std::vector<bool>& slip) {
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
    slip_.push_back(body < slip.size() && slip[body] ? 1 : 0);
    double extent = 0;
    for (const Vec3d& vertex : mesh.vertices) extent = std::max(extent, norm(vertex));
    extent_.push_back(extent);
  }
}

WallsView Walls::view() const {
  return {facets_.data(), grids_.data(), cell_start_.data(), cell_facet_.data(), poses_.data(),
          slip_.data(),   bodies()};
}

bool Walls::passed(const std::vector<dem::BodyPose>& poses_then, Vec3d then, Vec3d now) const {
  WallsView before = view();
  before.pose = poses_then.data();
  const WallsView after = view();
  for (std::uint32_t body = 0; body < bodies(); ++body)
    if (after.crossed(body, before.into_body(body, then), after.into_body(body, now))) return true;
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
