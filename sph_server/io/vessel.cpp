#include "sph_server/io/vessel.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

// So many sites of boxes are looked at, evenly.
constexpr std::size_t most_sites = 10000;

}  // namespace

BodyId vessel_of(const scene::Scene& scene, const std::vector<BodyWalls>& walls, const LiquidSetup& setup,
                 const std::vector<particles::BodyPose>& poses, const Sites& sites,
                 const std::vector<FilledInside>& insides) {
  const scene::Sph& sph = scene.sph.value();
  std::map<BodyId, double> held;  // particles
  for (const FilledInside& filled : insides) {
    const auto& fill = std::get<scene::LiquidInside>(sph.liquids.front().fill[filled.fill]);
    const auto wall = std::ranges::find(sph.walls, fill.wall, &scene::Wall::name);
    if (wall != sph.walls.end()) held[wall->body] += static_cast<double>(filled.particles);
  }
  std::set<BodyId> bodies;
  for (const BodyWalls& of : walls) bodies.insert(of.body);
  if (bodies.empty()) return ground;
  if (bodies.size() > 1 && !sites.position.empty()) {
    const double reach = 3 * sph.spacing;
    Walls near(setup.walls, reach);
    for (std::uint32_t w = 0; w < near.bodies(); ++w) near.set_pose(w, poses[w]);
    const std::size_t stride = 1 + sites.position.size() / most_sites;
    for (std::size_t i = 0; i < sites.position.size(); i += stride) {
      std::set<BodyId> beside;
      near.view().for_near(sites.position[i], reach, [&](std::uint32_t facet) {
        const std::uint32_t wall = near.facets()[facet].body;
        if (wall < walls.size()) beside.insert(walls[wall].body);
        return true;
      });
      for (const BodyId body : beside) held[body] += static_cast<double>(stride);
    }
  }
  if (held.empty()) return bodies.size() == 1 ? *bodies.begin() : ground;
  // Of equal shares the ground's counts.
  BodyId vessel = ground;
  double most = held.contains(ground) ? held[ground] : 0;
  for (const auto& [body, share] : held)
    if (share > most) {
      vessel = body;
      most = share;
    }
  return vessel;
}

std::optional<Vessel> vessel_in(const std::vector<BodyWalls>& walls, BodyId body) {
  if (body == ground) return std::nullopt;
  const auto first = std::ranges::find(walls, body, &BodyWalls::body);
  if (first == walls.end()) return std::nullopt;
  Vec3d low = first->mesh.vertices.front(), high = low;
  for (const BodyWalls& of : walls)
    if (of.body == body)
      for (const Vec3d& v : of.mesh.vertices)
        for (int a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], v[a]);
          high[a] = std::max(high[a], v[a]);
        }
  return Vessel{static_cast<std::uint32_t>(first - walls.begin()), 0.5 * (low + high)};
}

}  // namespace tandem::sph
