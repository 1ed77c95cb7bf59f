// The rows of the sums of walls (contact/wall_sums.hpp): one for each wall that has sensors, then
// one for each triangle of the walls with fields, wall by wall, in the order of the triangles of its mesh.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "dem_server/contact/wall_sums.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/surface.hpp"

namespace tandem::dem {

struct WallRowPlan {
  std::vector<WallRows> of_facet;        // empty where nothing is summed
  std::vector<std::uint32_t> of_sensor;  // row of each sensor of a wall
  std::uint32_t walls = 0;               // rows of walls
  std::uint32_t rows = 0;
};

inline bool sums_of_walls(const scene::Scene& scene) {
  return !scene.output.wall_fields.empty() ||
         std::ranges::any_of(scene.dem->sensors,
                             [](const scene::ParticleSensor& sensor) { return !sensor.wall.empty(); });
}

// Whether a scene needs sums that only the generic variant has.
inline bool has_sums(const scene::Scene& scene) {
  return sums_of_walls(scene) || scene.output.dissipation;
}

inline WallRowPlan plan_wall_rows(const scene::Scene& scene, const Surface& surface) {
  WallRowPlan plan;
  if (!sums_of_walls(scene)) return plan;
  plan.of_facet.resize(surface.facets.size());
  const auto each_facet = [&](const std::string& wall, auto visit) {
    for (std::size_t i = 0; i < surface.facets.size(); ++i) {
      const std::uint32_t owner = surface.patch_wall[surface.facets[i].patch];
      if (owner < scene.dem->walls.size() && scene.dem->walls[owner].name == wall) visit(plan.of_facet[i]);
    }
  };
  std::vector<std::string> walls;
  for (const scene::ParticleSensor& sensor : scene.dem->sensors) {
    if (sensor.wall.empty()) continue;
    const auto known = std::ranges::find(walls, sensor.wall);
    plan.of_sensor.push_back(static_cast<std::uint32_t>(known - walls.begin()));
    if (known != walls.end()) continue;
    walls.push_back(sensor.wall);
    each_facet(sensor.wall, [&](WallRows& rows) { rows.of_wall = plan.rows; });
    ++plan.rows;
  }
  plan.walls = plan.rows;
  for (const std::string& wall : scene.output.wall_fields)
    each_facet(wall, [&](WallRows& rows) { rows.of_facet = plan.rows++; });
  return plan;
}

}  // namespace tandem::dem
