// The liquid inside walls at the start.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "common/error.hpp"
#include "common/geometry/closing.hpp"
#include "common/geometry/mass_properties.hpp"
#include "common/scene/fault.hpp"
#include "particles/serving/boundary.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"
#include "sph_server/io/open_faces.hpp"
#include "sph_server/io/points.hpp"
#include "sph_server/neighbours/neighbour.hpp"

namespace tandem::sph {
namespace {

TriangleMesh in_world(TriangleMesh mesh, BodyId body, const scene::Scene& scene) {
  const particles::BodyPose pose = particles::pose_at_start(body, scene);
  for (Vec3d& v : mesh.vertices) v = pose.p + pose.R * v;
  return mesh;
}

// solid: with its normals outwards.
void take_out(const TriangleMesh& solid, TriangleMesh& region) {
  const auto first = static_cast<std::uint32_t>(region.vertices.size());
  region.vertices.insert(region.vertices.end(), solid.vertices.begin(), solid.vertices.end());
  for (const auto& t : solid.triangles)
    region.triangles.push_back({first + t[0], first + t[2], first + t[1]});
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

std::pair<Vec3d, Vec3d> bounds_of(const TriangleMesh& mesh) {
  Vec3d low = mesh.vertices.front(), high = low;
  for (const Vec3d& v : mesh.vertices)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], v[a]);
      high[a] = std::max(high[a], v[a]);
    }
  return {low, high};
}

Walls walls_at_start(const scene::Scene& scene, const std::vector<NamedMesh>& meshes) {
  Liquid liquid;
  liquid.spacing = scene.sph->spacing;
  std::vector<TriangleMesh> of_bodies;
  std::vector<particles::BodyPose> poses;
  for (const BodyWalls& body : walls_of_bodies(scene, meshes)) {
    of_bodies.push_back(body.mesh);
    poses.push_back(particles::pose_at_start(body.body, scene));
  }
  Walls walls(of_bodies, liquid.support());
  for (std::uint32_t b = 0; b < walls.bodies(); ++b) walls.set_pose(b, poses[b]);
  return walls;
}

// By how much the volumes of solids exceed that of their union, below a level along `up` [m3], by samples.
double common_volume(std::span<const TriangleMesh> solids, Vec3d up, double level) {
  constexpr int across = 40;
  double volume = 0;
  for (std::size_t s = 1; s < solids.size(); ++s) {
    const auto [low, high] = bounds_of(solids[s]);
    std::vector<std::size_t> others;  // before it, of which a part may be in it
    Vec3d begin = high, end = low;    // of all these parts
    for (std::size_t other = 0; other < s; ++other) {
      const auto [its_low, its_high] = bounds_of(solids[other]);
      Vec3d from, to;
      for (int a = 0; a < 3; ++a) {
        from[a] = std::max(low[a], its_low[a]);
        to[a] = std::min(high[a], its_high[a]);
      }
      if (from.x >= to.x || from.y >= to.y || from.z >= to.z) continue;
      others.push_back(other);
      for (int a = 0; a < 3; ++a) {
        begin[a] = std::min(begin[a], from[a]);
        end[a] = std::max(end[a], to[a]);
      }
    }
    if (others.empty()) continue;
    const Vec3d step = (1.0 / across) * (end - begin);
    std::size_t count = 0;
    for (int k = 0; k < across; ++k)
      for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i) {
          const Vec3d x = begin + Vec3d{(i + 0.5) * step.x, (j + 0.5) * step.y, (k + 0.5) * step.z};
          const auto has = [&](std::size_t solid) { return winding_number(solids[solid], x) > 0.5; };
          count += dot(x, up) < level && has(s) && std::ranges::any_of(others, has) ? 1 : 0;
        }
    volume += static_cast<double>(count) * step.x * step.y * step.z;
  }
  return volume;
}

// Corners are one within this, and liquid passes openings from this width on [spacings].
constexpr double joined_corners = 1e-3, passable = 0.5;

// The liquid would be on both sides of a wall that was meant to be a solid.
void refuse_nearly_closed(const Closing& closing, const std::string& wall, std::size_t fill) {
  if (closing.closure != Closure::flipped && closing.closure != Closure::slit) return;
  const std::string width =
      closing.closure == Closure::slit ? fmt::format(" of at most {:.3g} m", closing.width) : "";
  throw Error(
      ErrorCode::scene,
      fmt::format("wall '{}' is nearly a solid, but {}{}: the liquid would be inside of it as well", wall,
                  closing.why, width),
      place_of_fill(fill),
      "repair the mesh in the program that made it; where liquid is meant on both sides, leave an opening "
      "of a spacing");
}

// The closed walls that are in the region below `level` along `up`, with their normals outwards. A wall may
// stand on the surface of the region. What a wall leaves open and no other one closes has liquid on both
// sides.
std::vector<TriangleMesh> solids_in(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                    const std::string& wall, Vec3d up, double level, std::size_t fill,
                                    const TriangleMesh& region) {
  const double spacing = scene.sph->spacing;
  const Walls walls = walls_at_start(scene, meshes);
  std::vector<TriangleMesh> solids;
  for (const scene::Wall& other : scene.sph->walls) {
    if (other.name == wall || std::holds_alternative<scene::PlaneShape>(other.shape)) continue;
    Closing closing = closing_of(in_world(whole_mesh_of(other, *scene.sph, meshes), other.body, scene),
                                 joined_corners * spacing, passable * spacing);
    refuse_nearly_closed(closing, other.name, fill);
    if (closing.closure != Closure::solid) continue;
    TriangleMesh mesh = std::move(closing.mesh);
    if (is_inside_out(mesh)) turn_over(mesh);
    std::optional<Vec3d> inside, outside;
    for (const auto& t : mesh.triangles) {
      const Vec3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]],
                  into = -1e-3 * spacing * normalized(cross(b - a, c - a));
      for_points(a, b, c, spacing, [&](Vec3d x) {
        if ((inside && outside) || dot(x + into, up) > level) return;
        (winding_number(region, x + into) > 0.5 ? inside : outside) = x;
      });
    }
    if (!inside || open_face(other, scene, meshes, walls, up, level)) continue;
    if (outside)
      throw Error(ErrorCode::scene,
                  fmt::format("wall '{}' passes through wall '{}' below the level: {} m is outside of it",
                              other.name, wall, scene::rounded(*outside)),
                  place_of_fill(fill), fmt::format("let '{}' end at '{}', or fill boxes", other.name, wall));
    solids.push_back(std::move(mesh));
  }
  return solids;
}

// Twice the volume over the surface is the width of a thin shell, as of the metal of a vessel that a program
// for drawing exports as one solid.
void refuse_narrow(const TriangleMesh& region, Vec3d up, double high, double spacing, std::size_t fill) {
  double area = 0;
  for (const auto& t : region.triangles)
    area += 0.5 * norm(cross(region.vertices[t[1]] - region.vertices[t[0]],
                             region.vertices[t[2]] - region.vertices[t[0]]));
  const double width = 2 * volume_below(region, up, high) / area;
  if (width < spacing)
    throw Error(
        ErrorCode::scene,
        fmt::format("the region is {:.3g} m wide on average, less than sph.spacing of {:.3g} m", width,
                    spacing),
        place_of_fill(fill),
        "take a smaller spacing; if the mesh is a vessel with the thickness of its metal, fill a wall that "
        "is the surface of its cavity alone");
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
    filled.region = closing_of(in_world(whole_mesh_of(wall, sph, meshes), wall.body, scene),
                               joined_corners * sph.spacing, passable * sph.spacing)
                        .mesh;
    if (is_inside_out(filled.region)) turn_over(filled.region);
    const Mat3d body = particles::pose_at_start(wall.body, scene).R, own = wall.pose.q_WB.matrix();
    for (int a = 0; a < 3; ++a) {
      Vec3d axis;
      axis[a] = 1;
      axis = body * (own * axis);
      for (int r = 0; r < 3; ++r) filled.axes.row[r][a] = axis[r];
    }
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
      filled.amount.volume = inside->mass ? *inside->mass / sph.liquids.front().density : inside->volume;
      filled.amount.mass = inside->mass;
    }
    // The volume is that of the liquid alone; a wall that is in it raises the level.
    const auto depth = [&] {
      return placed_at(k, [&] { return depth_of(filled.region, scene.gravity, filled.amount); });
    };
    filled.depth = depth();
    const std::vector<TriangleMesh> solids =
        solids_in(scene, meshes, wall.name, up, inside->level.value_or(high), k, filled.region);
    for (const TriangleMesh& solid : solids) take_out(solid, filled.region);
    if (const double top = low + filled.depth, spacing = sph.spacing;
        !solids.empty() &&
        !(volume_below(filled.region, up, inside->level ? top : high) > spacing * spacing * spacing))
      throw Error(ErrorCode::scene,
                  fmt::format("the closed walls in wall '{}' leave no room for the liquid", wall.name),
                  place_of_fill(k), "leave out those that are the same as the wall, or fill boxes");
    refuse_narrow(filled.region, up, high, sph.spacing, k);
    filled.depth = depth();
    // Where a volume is given, the level depends on what the solids have in common below it.
    for (int n = 0; n < (solids.size() < 2 ? 0 : inside->level ? 1 : 3); ++n) {
      filled.amount.common = common_volume(solids, up, low + filled.depth);
      filled.depth = depth();
    }
    if (filled.depth < sph.spacing * (1 - 1e-9))
      throw Error(ErrorCode::scene,
                  fmt::format("the liquid is {:.3g} m deep there, less than sph.spacing of {:.3g} m",
                              filled.depth, sph.spacing),
                  place_of_fill(k), "give a tenth of the depth as the spacing, or more liquid");
    const double cube = sph.spacing * sph.spacing * sph.spacing,
                 count = (volume_below(filled.region, up, low + filled.depth) + filled.amount.common) / cube;
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

FilledPlaces places_of(const FilledInside& filled, const LiquidSetup& setup,
                       const std::vector<particles::BodyPose>& poses, const AfterStep& after_step) {
  return placed_at(filled.fill, [&] { return fill_places(setup, poses, filled, after_step); });
}

LiquidState liquid_at_start(const scene::Scene& scene, const Sites& sites,
                            const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                            const std::vector<particles::BodyPose>& poses, Vec3d velocity,
                            const PlacesByFill& places) {
  const scene::Liquid& liquid = scene.sph->liquids.front();
  LiquidState all = fill_of(sites, liquid, setup.liquid, velocity);
  std::vector<std::size_t> from(all.size(),
                                liquid.fill.size());  // fill of each particle, that of boxes unknown
  for (const FilledInside& filled : insides) {
    const auto given = places.find(place_of_fill(filled.fill));
    const LiquidState part = placed_at(filled.fill, [&] {
      return given != places.end() ? at_rest_in(setup, filled, given->second)
                                   : fill_region(setup, poses, filled);
    });
    all.position.insert(all.position.end(), part.position.begin(), part.position.end());
    all.compression.insert(all.compression.end(), part.compression.begin(), part.compression.end());
    all.velocity.resize(all.size(), velocity);
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
