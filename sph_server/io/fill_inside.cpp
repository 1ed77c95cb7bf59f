// The liquid inside walls at the start.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/error.hpp"
#include "common/geometry/mass_properties.hpp"
#include "common/scene/fault.hpp"
#include "particles/serving/boundary.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"
#include "sph_server/neighbours/neighbour.hpp"

namespace tandem::sph {
namespace {

TriangleMesh in_world(TriangleMesh mesh, BodyId body, const scene::Scene& scene) {
  const particles::BodyPose pose = particles::pose_at_start(body, scene);
  for (Vec3d& v : mesh.vertices) v = pose.p + pose.R * v;
  return mesh;
}

void join(const TriangleMesh& mesh, TriangleMesh& to) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& t : mesh.triangles) to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// An error of fill_region() with the place in the scene.
template <class Call>
auto placed_at(std::size_t fill, Call call) {
  try {
    return call();
  } catch (const Error& error) {
    if (error.where() != "fill") throw;
    throw Error(error.code(), error.problem(), place_of_fill(fill), error.hint());
  }
}

// Of a vertex that is on the surface of the region the winding number is between 0 and 1.
constexpr double clearly_outside = 0.1, clearly_inside = 0.9;

// Takes the insides of other closed walls out of the region, up to `level` along `up`.
void take_out(const scene::Scene& scene, const std::vector<NamedMesh>& meshes, const std::string& wall,
              Vec3d up, double level, std::size_t fill, TriangleMesh& region) {
  const TriangleMesh whole = region;
  for (const scene::Wall& other : scene.sph->walls) {
    if (other.name == wall || std::holds_alternative<scene::PlaneShape>(other.shape)) continue;
    TriangleMesh mesh = in_world(whole_mesh_of(other, *scene.sph, meshes), other.body, scene);
    std::size_t inside = 0, outside = 0;
    for (const Vec3d& v : mesh.vertices) {
      if (dot(v, up) > level) continue;
      const double winding = winding_number(whole, v);
      inside += winding > clearly_inside ? 1 : 0;
      outside += winding < clearly_outside ? 1 : 0;
    }
    if (inside == 0 || !why_not_solid(mesh).empty()) continue;
    if (outside > 0)
      throw Error(ErrorCode::scene,
                  fmt::format("wall '{}' passes through wall '{}' below the level", other.name, wall),
                  place_of_fill(fill), "let it end there, or fill boxes");
    if (!is_inside_out(mesh)) turn_over(mesh);
    join(mesh, region);
  }
}

}  // namespace

bool is_below(const FilledInside& filled, Vec3d x, Vec3d up) {
  double low = std::numeric_limits<double>::infinity();
  for (const Vec3d& v : filled.region.vertices) low = std::min(low, dot(v, up));
  return dot(x, up) < low + filled.depth && winding_number(filled.region, x) > 0.5;
}

std::string place_of_fill(std::size_t fill) {
  return "sph.liquids[0]." + scene::element("fill", fill);
}

std::vector<FilledInside> insides_of(const scene::Scene& scene, const std::vector<NamedMesh>& meshes) {
  std::vector<FilledInside> all;
  const scene::Sph& sph = scene.sph.value();
  const auto& fills = sph.liquids.front().fill;
  for (std::size_t k = 0; k < fills.size(); ++k) {
    const auto* inside = std::get_if<scene::LiquidInside>(&fills[k]);
    if (!inside) continue;
    const Vec3d up = -1.0 / norm(scene.gravity) * scene.gravity;
    const scene::Wall& wall = *std::ranges::find(sph.walls, inside->wall, &scene::Wall::name);
    FilledInside filled;
    filled.fill = k;
    filled.region = in_world(whole_mesh_of(wall, sph, meshes), wall.body, scene);
    if (is_inside_out(filled.region)) turn_over(filled.region);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3d& v : filled.region.vertices) {
      low = std::min(low, dot(v, up));
      high = std::max(high, dot(v, up));
    }
    if (inside->level) {
      if (!(*inside->level > low && *inside->level <= high + 1e-9 * (high - low)))
        throw Error(ErrorCode::scene,
                    fmt::format("the level of {:.6g} m is not in wall '{}', which is from {:.6g} to {:.6g} m "
                                "against gravity",
                                *inside->level, wall.name, low, high),
                    place_of_fill(k), "give a level between them");
      filled.amount.height = *inside->level - low;
    } else {
      filled.amount.volume = inside->volume;
    }
    // The volume is that of the liquid alone; a wall that is in it raises the level.
    const auto depth = [&] {
      return placed_at(k, [&] { return depth_of(filled.region, scene.gravity, filled.amount); });
    };
    filled.depth = depth();
    take_out(scene, meshes, wall.name, up, inside->level.value_or(high), k, filled.region);
    filled.depth = depth();
    if (filled.depth < sph.spacing * (1 - 1e-9))
      throw Error(ErrorCode::scene,
                  fmt::format("the liquid is {:.3g} m deep there, less than sph.spacing of {:.3g} m",
                              filled.depth, sph.spacing),
                  place_of_fill(k), "give a tenth of the depth as the spacing, or more liquid");
    const double cube = sph.spacing * sph.spacing * sph.spacing,
                 count = volume_below(filled.region, up, low + filled.depth) / cube;
    if (count >= Neighbour::most)
      throw Error(
          ErrorCode::scene,
          fmt::format("the liquid has {:.4g} particles there, more than {}", count, Neighbour::most - 1),
          place_of_fill(k), "give a larger sph.spacing");
    filled.particles = static_cast<std::size_t>(count);
    all.push_back(std::move(filled));
  }
  return all;
}

LiquidState liquid_at_start(const scene::Scene& scene, const Sites& sites,
                            const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                            const std::vector<particles::BodyPose>& poses) {
  const scene::Liquid& liquid = scene.sph->liquids.front();
  LiquidState all = fill_of(sites, liquid, setup.liquid);
  std::vector<std::size_t> from(all.size(),
                                liquid.fill.size());  // fill of each particle, that of boxes unknown
  for (const FilledInside& filled : insides) {
    const LiquidState part =
        placed_at(filled.fill, [&] { return fill_region(setup, poses, filled.region, filled.amount); });
    all.position.insert(all.position.end(), part.position.begin(), part.position.end());
    all.compression.insert(all.compression.end(), part.compression.begin(), part.compression.end());
    all.velocity.resize(all.size(), liquid.velocity);
    from.resize(all.size(), filled.fill);
  }
  const Vec3d up = -1.0 / norm(scene.gravity) * scene.gravity;  // needed where there are insides only
  if (liquid.fill.size() > 1)
    for (const FilledInside& filled : insides)
      for (std::size_t i = 0; i < all.size(); ++i)
        if (from[i] != filled.fill && is_below(filled, all.position[i], up))
          throw Error(ErrorCode::scene,
                      fmt::format("another fill is in it as well, at {} m", scene::rounded(all.position[i])),
                      place_of_fill(filled.fill), "the liquid would be there twice: leave one of them out");
  return all;
}

}  // namespace tandem::sph
