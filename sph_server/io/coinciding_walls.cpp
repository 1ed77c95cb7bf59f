#include "sph_server/io/coinciding_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/kernel/visible_part.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

// Facets whose overlap is less than this share of the smaller one touch each other by rounding.
constexpr double least_overlap = 1e-3;
constexpr double parallel = 0.999;  // cosine; facets at a larger angle have no area within the tolerance

double area_of(const Polygon& p, Vec3d normal) {
  Vec3d sum;
  for (int k = 2; k < p.count; ++k) sum += cross(p.corner[k - 1] - p.corner[0], p.corner[k] - p.corner[0]);
  return 0.5 * std::fabs(dot(sum, normal));
}

// The part of g that is less than `tolerance` from f.
Polygon overlap_of(const NearFacet& f, const NearFacet& g, double tolerance) {
  Polygon part;
  part.count = 3;
  part.corner[0] = g.a;
  part.corner[1] = g.b;
  part.corner[2] = g.c;
  for (const double side : {-1.0, 1.0})
    part = clipped(part, f.a + side * tolerance * f.normal, -side * f.normal);
  const Vec3d corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k)
    part = clipped(part, corner[k], cross(f.normal, corner[k < 2 ? k + 1 : 0] - corner[k]));
  return part;
}

// The point of a polygon in a plane that is nearest to x.
Vec3d nearest_point(const Polygon& p, Vec3d normal, Vec3d x) {
  const Vec3d foot = x - dot(x - p.corner[0], normal) * normal;
  Vec3d nearest = foot;
  double least = std::numeric_limits<double>::infinity(), sign = 0;
  bool inside = true;
  for (int k = 0; k < p.count; ++k) {
    const Vec3d a = p.corner[k], edge = p.corner[k + 1 < p.count ? k + 1 : 0] - a;
    if (norm2(edge) == 0) continue;
    const double across = dot(cross(edge, foot - a), normal);
    inside = inside && across * sign >= 0;
    if (across != 0) sign = across;
    const Vec3d on_edge = a + std::clamp(dot(foot - a, edge) / norm2(edge), 0.0, 1.0) * edge;
    if (const double d = norm(foot - on_edge); d < least) {
      least = d;
      nearest = on_edge;
    }
  }
  return inside ? foot : nearest;
}

Vec3d middle_of(const Polygon& p) {
  Vec3d sum;
  for (int k = 0; k < p.count; ++k) sum += (1.0 / p.count) * p.corner[k];
  return sum;
}

// The middle of what a polygon has within `size` of one of its points: also where it is narrow, as the side
// of a plate, it is off the edges, at which another wall may end that hides the rest.
Vec3d beside_edge(const Polygon& p, Vec3d normal, Vec3d point, double size) {
  const Vec3d axis_off{std::fabs(normal.x) < 0.6 ? 1.0 : 0.0, std::fabs(normal.x) < 0.6 ? 0.0 : 1.0, 0.0},
      u = normalized(cross(normal, axis_off)), v = cross(normal, u);
  Polygon around = p;
  for (const Vec3d axis : {u, v, -u, -v}) around = clipped(around, point + size * axis, -axis);
  return around.count > 0 ? middle_of(around) : middle_of(p);
}

struct Box {
  Vec3d low, high;  // [m]
};
bool touch(const Box& a, const Box& b, double tolerance) {
  for (int k = 0; k < 3; ++k)
    if (a.low[k] > b.high[k] + tolerance || b.low[k] > a.high[k] + tolerance) return false;
  return true;
}

// Two facets, and where they are one.
struct Overlap {
  std::size_t first = 0, second = 0;
  Polygon part;
  Box around;
};
std::vector<Overlap> overlaps_of(const std::vector<NearFacet>& facets, double tolerance) {
  std::vector<Box> around;
  for (const NearFacet& f : facets) {
    Box& box = around.emplace_back();
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min({f.a[k], f.b[k], f.c[k]});
      box.high[k] = std::max({f.a[k], f.b[k], f.c[k]});
    }
  }
  std::vector<std::size_t> order(facets.size()), open;  // open: that may reach the next one along x
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return std::pair(around[k].low.x, k); });
  std::vector<Overlap> all;
  for (const std::size_t k : order) {
    std::erase_if(open, [&](std::size_t o) { return around[o].high.x < around[k].low.x - tolerance; });
    for (const std::size_t o : open) {
      const NearFacet &f = facets[std::min(k, o)], &g = facets[std::max(k, o)];
      if (!touch(around[k], around[o], tolerance) || std::fabs(dot(f.normal, g.normal)) < parallel) continue;
      const Polygon part = overlap_of(f, g, tolerance);
      const double smaller =
          0.5 * std::min(norm(cross(f.b - f.a, f.c - f.a)), norm(cross(g.b - g.a, g.c - g.a)));
      if (part.count == 0 || area_of(part, f.normal) < least_overlap * smaller) continue;
      Box box{part.corner[0], part.corner[0]};
      for (int c = 1; c < part.count; ++c)
        for (int a = 0; a < 3; ++a) {
          box.low[a] = std::min(box.low[a], part.corner[c][a]);
          box.high[a] = std::max(box.high[a], part.corner[c][a]);
        }
      all.push_back({std::min(k, o), std::max(k, o), part, box});
    }
    open.push_back(k);
  }
  return all;
}

}  // namespace

void refuse_coinciding_walls(const std::vector<Vec3d>& particles, const std::vector<BodyWalls>& walls,
                             const std::vector<Inlet>& inlets, const LiquidSetup& setup,
                             const std::vector<particles::BodyPose>& poses, const scene::Scene& scene) {
  const double R = setup.liquid.support(), spacing = setup.liquid.spacing;
  Walls all(setup.walls, R);
  for (std::uint32_t b = 0; b < all.bodies(); ++b) all.set_pose(b, poses[b]);
  std::vector<NearFacet> facets;
  std::vector<std::uint32_t> first(all.bodies());  // facet of each body
  for (std::uint32_t f = 0; f < all.facets().size(); ++f) {
    facets.push_back(all.view().in_world(f));
    if (f == 0 || facets[f].body != facets[f - 1].body) first[facets[f].body] = f;
  }
  const std::vector<Overlap> overlaps = overlaps_of(facets, 1e-6 * R);
  if (overlaps.empty()) return;
  const auto name_of = [&](std::size_t facet) {
    const std::uint32_t b = facets[facet].body;
    if (b >= walls.size()) return fmt::format("inlet '{}'", inlets[b - walls.size()].of.name);
    return fmt::format("wall '{}' of '{}'", walls[b].wall[facet - first[b]], scene.body_name(walls[b].body));
  };
  const auto check = [&](Vec3d x) {
    for (const Overlap& o : overlaps) {
      if (!touch({x, x}, o.around, R)) continue;
      const Vec3d normal = facets[o.first].normal,
                  at = beside_edge(o.part, normal, nearest_point(o.part, normal, x), 0.5 * spacing);
      if (norm(x - at) >= R || all.between(x, x + (1 - 1e-5) * (at - x))) continue;
      throw Error(ErrorCode::scene,
                  fmt::format("{} and {} lie on each other at {} m, where the liquid sees them: both would "
                              "act on it",
                              name_of(o.first), name_of(o.second), scene::rounded(at)),
                  "sph.walls",
                  "leave one of them out there, as by 'open' faces of a box or a cylinder, or put the one "
                  "that the liquid touches a hundredth of a spacing in front of the other");
    }
  };
  for (const Vec3d& x : particles) check(x);
  for (const Inlet& inlet : inlets)
    for (const Vec3d& site : inlet.site)
      check(inlet.of.pose.p_WB + inlet.of.pose.q_WB.rotate(site + Vec3d{0, 0, 0.5 * inlet.thickness}));
}

}  // namespace tandem::sph
