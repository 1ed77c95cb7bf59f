#include "particles/geometry/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/error.hpp"
#include "particles/geometry/analytic_facets.hpp"
#include "particles/geometry/facet_grid.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/geometry/smooth_patches.hpp"

namespace tandem::particles {
namespace {

// For all grids together: 8 MiB of cells and 32 MiB of lists, but never less than the facets of a body need.
constexpr std::size_t cell_budget = std::size_t{1} << 21;
constexpr std::size_t entry_budget = std::size_t{1} << 23;
constexpr std::size_t entries_per_facet = 16;
// Balls up to this radius over `reach` are listed in the grid. The few larger ones would force coarse cells
// on all other facets.
constexpr double largest_listed_ball = 32;

std::string position(const scene::Dem& dem, const scene::Wall& wall) {
  return "dem.walls[" + std::to_string(&wall - dem.walls.data()) + "] '" + wall.name + "'";
}

const TriangleMesh& find_mesh(const std::vector<NamedMesh>& meshes, const std::string& wall,
                              const std::string& where) {
  for (const NamedMesh& named : meshes) {
    if (named.name == wall) return named.mesh;
  }
  throw Error(ErrorCode::scene, "no mesh came with the scene for this wall", where,
              "the coordinator sends one for each wall with a file");
}

// The wall's triangles in its body's frame.
TriangleMesh body_mesh(const scene::Wall& wall, const std::vector<NamedMesh>& meshes,
                       const std::string& where) {
  TriangleMesh mesh;
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) {
    mesh = box_mesh(box->size, box->open);
  } else if (const auto* prism = std::get_if<scene::CylinderShape>(&wall.shape)) {
    mesh = cylinder_mesh(prism->radius, prism->height.value(), prism->segments.value(), prism->open);
  } else {
    mesh = find_mesh(meshes, wall.name, where);
  }
  if (mesh.triangles.empty())
    throw Error(ErrorCode::scene, "the mesh has no triangles", where, "remove the wall");
  const std::vector<std::size_t> bad = degenerate_triangles(mesh);
  if (!bad.empty()) {
    throw Error(ErrorCode::scene,
                "triangle " + std::to_string(bad.front()) + " has no area or a wrong vertex (" +
                    std::to_string(bad.size()) + " of " + std::to_string(mesh.triangles.size()) +
                    " triangles)",
                where, "clean the mesh: remove triangles without area");
  }
  return transformed(std::move(mesh), wall.pose);
}

// Positions of the fixed sphere in the domain and, beyond periodic faces, wherever moving spheres may touch
// it. Moving spheres may be beyond a face by at most the skin, which is part of the reach.
std::vector<Vec3d> images_near_domain(const FixedSphere& sphere, const Periods& periods, double reach) {
  std::vector<Vec3d> images{periods.wrapped(sphere.position)};
  const double beyond = sphere.radius + reach;
  for (int a = 0; a < 3; ++a) {
    if (!(periods.length[a] > 0)) continue;
    for (std::size_t k = 0, known = images.size(); k < known; ++k)
      for (const double shift : {-periods.length[a], periods.length[a]}) {
        Vec3d image = images[k];
        image[a] += shift;
        if (image[a] > periods.min[a] - beyond && image[a] < periods.min[a] + periods.length[a] + beyond)
          images.push_back(image);
      }
  }
  return images;
}

// Adds the walls of one body: triangles first, then the balls in the grid, then the facets that are tested
// everywhere, so that each of these is one range.
void add_body(Surface& surface, const scene::Dem& dem, const std::vector<const scene::Wall*>& walls,
              const std::vector<NamedMesh>& meshes, std::span<const FixedSphere> fixed, GridBudget budget) {
  const auto body = static_cast<std::uint32_t>(surface.grids.size());
  const std::size_t first = surface.facets.size();
  double extent = 0;
  std::vector<Facet> balls, analytic;
  const auto add_analytic = [&](Facet facet) {
    facet.patch = static_cast<std::uint32_t>(surface.patches.size());
    facet.body = body;
    extent = std::max(extent, extent_of(facet));
    const bool is_listed =
        facet.kind == FacetKind::ball && facet.radius() <= largest_listed_ball * surface.reach;
    (is_listed ? balls : analytic).push_back(facet);
  };
  const auto add_patch = [&](std::uint32_t material, std::size_t owner) {
    surface.patches.push_back({material});
    surface.patch_wall.push_back(static_cast<std::uint32_t>(owner));
  };
  for (const scene::Wall* wall : walls) {
    const std::string where = position(dem, *wall);
    const auto first_patch = static_cast<std::uint32_t>(surface.patches.size());
    const Patch patch{wall->material.value};
    if (is_analytic(wall->shape)) {
      for (const Facet& facet : analytic_facets(*wall, where)) {
        add_analytic(facet);
        add_patch(wall->material.value, static_cast<std::size_t>(wall - dem.walls.data()));
      }
      continue;
    }
    const TriangleMesh mesh = body_mesh(*wall, meshes, where);
    const std::vector<std::uint32_t> patches = smooth_patches(mesh);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      Facet facet = triangle_facet(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
      facet.patch = first_patch + patches[i];
      facet.body = body;
      extent = std::max({extent, norm(facet.a), norm(facet.b), norm(facet.c)});
      surface.facets.push_back(facet);
    }
    const std::uint32_t count = *std::max_element(patches.begin(), patches.end()) + 1;
    surface.patches.insert(surface.patches.end(), count, patch);
    surface.patch_wall.insert(surface.patch_wall.end(), count,
                              static_cast<std::uint32_t>(wall - dem.walls.data()));
  }
  const Periods periods = periods_of(dem);
  for (const FixedSphere& sphere : fixed) {
    for (const Vec3d& centre : images_near_domain(sphere, periods, surface.reach))
      add_analytic(ball_facet(centre, sphere.radius));
    add_patch(sphere.material, dem.walls.size() + sphere.group);
  }
  surface.facets.insert(surface.facets.end(), balls.begin(), balls.end());
  const std::size_t listed = surface.facets.size() - first;
  budget.entries = std::max(budget.entries, entries_per_facet * listed);
  // Facets and entries have 32-bit indices.
  const std::size_t most =
      std::max(surface.facets.size() + analytic.size(), surface.cell_facet.size() + budget.entries);
  if (most > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::resource,
                "the walls have too many facets (" + std::to_string(surface.facets.size()) + ")", "dem.walls",
                "use coarser meshes");
  }
  FacetGrid grid =
      make_facet_grid(std::span(surface.facets).subspan(first), static_cast<std::uint32_t>(first),
                      surface.reach, budget, surface.cell_start, surface.cell_facet);
  grid.first_analytic = static_cast<std::uint32_t>(surface.facets.size());
  grid.analytic = static_cast<std::uint32_t>(analytic.size());
  surface.facets.insert(surface.facets.end(), analytic.begin(), analytic.end());
  surface.grids.push_back(grid);
  surface.body_extent.push_back(extent);
}

}  // namespace

std::string patch_name(const Surface& surface, std::uint32_t patch, const scene::Dem& dem) {
  const std::size_t owner = surface.patch_wall[patch], walls = dem.walls.size();
  return owner < walls ? "wall '" + dem.walls[owner].name + "'"
                       : "a fixed sphere of '" + dem.particles[owner - walls].name + "'";
}

void expect_single_images(std::span<const FixedSphere> fixed, const scene::Dem& dem, double largest) {
  const Periods periods = periods_of(dem);
  for (const FixedSphere& sphere : fixed)
    for (int a = 0; a < 3; ++a)
      if (const double period = periods.length[a], reach = 2 * (sphere.radius + largest);
          period > 0 && reach > period)
        throw Error(
            ErrorCode::scene,
            fmt::format("a fixed sphere of radius {:.6g} m in a domain of {:.6g} m along the periodic "
                        "axis {}: one of radius {:.6g} m could touch two of its images at once",
                        sphere.radius, period, "xyz"[a], largest),
            "dem.particles[" + std::to_string(sphere.group) + "]",
            fmt::format("use smaller ones, or a period of at least {:.6g} m", reach));
}

Surface make_surface(const scene::Scene& scene, const std::vector<NamedMesh>& meshes, double reach,
                     std::span<const FixedSphere> fixed) {
  if (!(reach > 0) || !std::isfinite(reach)) {
    throw Error(ErrorCode::internal, "reach of the wall search is " + std::to_string(reach) + " m",
                "make_surface");
  }
  const scene::Dem& dem = scene.dem.value();
  // Of each body the walls that move with it, and its belts.
  struct Walls {
    std::vector<const scene::Wall*> fixed, belts;
  };
  std::map<std::uint32_t, Walls> walls_of;
  Walls ground_walls;
  std::size_t bodies = 1;
  for (const scene::Wall& wall : dem.walls) {
    Walls& walls = wall.body == ground ? ground_walls : walls_of[wall.body.value];
    (wall.surface_velocity ? walls.belts : walls.fixed).push_back(&wall);
  }
  bodies += ground_walls.belts.size();
  for (const auto& [body, walls] : walls_of) bodies += (walls.fixed.empty() ? 0 : 1) + walls.belts.size();

  Surface surface;
  surface.reach = reach;
  surface.cell_start.push_back(0);
  const GridBudget budget{std::max<std::size_t>(cell_budget / bodies, 1),
                          std::max<std::size_t>(entry_budget / bodies, 1)};
  const auto add = [&](BodyId body, const std::vector<const scene::Wall*>& walls, std::uint32_t belt,
                       std::span<const FixedSphere> spheres) {
    surface.boundary_bodies.push_back(body);
    surface.belt_wall.push_back(belt);
    add_body(surface, dem, walls, meshes, spheres, budget);
  };
  const auto add_belts = [&](BodyId body, const std::vector<const scene::Wall*>& belts) {
    for (const scene::Wall* belt : belts)
      add(body, {belt}, static_cast<std::uint32_t>(belt - dem.walls.data()), {});
  };
  add(ground, ground_walls.fixed, no_belt, fixed);
  add_belts(ground, ground_walls.belts);
  for (const auto& [body, walls] : walls_of) {
    if (!walls.fixed.empty()) add(BodyId{body}, walls.fixed, no_belt, {});
    add_belts(BodyId{body}, walls.belts);
  }
  return surface;
}

}  // namespace tandem::particles
