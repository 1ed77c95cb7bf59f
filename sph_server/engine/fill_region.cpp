#include "sph_server/engine/fill_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "sph_server/engine/cut_lattice.hpp"
#include "sph_server/engine/put_back.hpp"
#include "sph_server/engine/region_columns.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

// docs/experiments/2026-11-sph-fill.md
constexpr Packing spreading{3.0, 0.88, 60}, parting{0.1, 0.8, 20};
constexpr int most_rounds = 4;  // of both

// A rectangle at the surface that covers the region.
TriangleMesh lid_of(const FilledPart& part, const LatticeAxes& axes, double margin) {
  constexpr double none = std::numeric_limits<double>::infinity();
  double low[2]{none, none}, high[2]{-none, -none};
  for (const Vec3d& v : part.region.vertices)
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], dot(v, axes.axis[a]) - margin);
      high[a] = std::max(high[a], dot(v, axes.axis[a]) + margin);
    }
  TriangleMesh mesh;
  for (const auto& [x, y] : {std::pair{low[0], low[1]}, std::pair{high[0], low[1]},
                             std::pair{high[0], high[1]}, std::pair{low[0], high[1]}})
    mesh.vertices.push_back(x * axes.axis[0] + y * axes.axis[1] + part.surface * part.up);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

LiquidState at_rest_at(const std::vector<Vec3d>& position, const Liquid& liquid, Vec3d up, double surface) {
  LiquidState state;
  state.position = position;
  state.velocity.resize(position.size());
  state.compression.reserve(position.size());
  for (const Vec3d& x : position)
    state.compression.push_back(at_rest(liquid, surface - dot(x, up)).compression);
  return state;
}

// Numbers of the places that are not in the region, or above its surface by more than half a spacing.
std::vector<std::size_t> outside(const std::vector<Vec3d>& places, const FilledPart& part,
                                 const LatticeAxes& axes, double spacing) {
  const RegionColumns columns(part.region, axes.axis);
  ColumnCrossings crossings;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3d x = places[i];
    const double height = dot(x, part.up);
    columns.find(dot(x, axes.axis[0]), dot(x, axes.axis[1]), crossings);
    if (height > part.surface + 0.5 * spacing || !crossings.inside(height)) left.push_back(i);
  }
  return left;
}

// Refuses particles in a flat layer on a wall that is much thinner than they are. Beaches end thin as well,
// but not flat.
void refuse_shallow(const std::vector<Vec3d>& places, const FilledPart& part, const LatticeAxes& axes,
                    double spacing) {
  constexpr double room = 0.25, flat = 0.1;  // spacings; of the depth
  const RegionColumns columns(part.region, axes.axis);
  const auto depth_at = [&](double x, double y) {
    ColumnCrossings crossings;
    columns.find(x, y, crossings);
    return crossings.depth_below(part.surface);
  };
  for (const Vec3d& at : places) {
    if (dot(at, part.up) < part.surface - room * spacing) continue;
    const double x = dot(at, axes.axis[0]), y = dot(at, axes.axis[1]), depth = depth_at(x, y);
    if (!(depth > 0 && depth < room * spacing)) continue;
    bool is_flat = true;
    for (const double way : {-0.5 * spacing, 0.5 * spacing})
      is_flat = is_flat && std::fabs(depth_at(x + way, y) - depth) < flat * depth &&
                std::fabs(depth_at(x, y + way) - depth) < flat * depth;
    if (!is_flat) continue;
    throw Error(
        ErrorCode::scene,
        fmt::format("the liquid is {:.2g} m deep over a wall at ({:.4g}, {:.4g}, {:.4g}) m, less than a "
                    "quarter of sph.spacing",
                    depth, at.x, at.y, at.z),
        "fill",
        fmt::format("give a level up to that wall or {:.2g} m above it, or a spacing of {:.2g} m", spacing,
                    depth));
  }
}

[[noreturn]] void refuse_left(const std::vector<Vec3d>& places, const std::vector<std::size_t>& left) {
  const Vec3d x = places[left[0]];
  throw Error(ErrorCode::scene,
              fmt::format("{} left the region while {} packed, at ({:.4g}, {:.4g}, {:.4g}) m",
                          left.size() == 1 ? "a particle" : std::to_string(left.size()) + " particles",
                          left.size() == 1 ? "it was" : "they were", x.x, x.y, x.z),
              "fill",
              "close the walls around the liquid, or take a spacing of less than half of the narrowest gap");
}

// walls: those of the setup.
std::vector<Vec3d> relaxed(const LiquidSetup& setup, std::vector<particles::BodyPose> poses,
                           const Walls& walls, const FilledPart& part, const LatticeAxes& axes,
                           const std::vector<Vec3d>& sites, const AfterStep& after_step) {
  LiquidSetup packing = setup;
  packing.liquid.shifting = 0;
  // Viscosity would only shorten the steps.
  packing.liquid.viscosity = packing.liquid.artificial = 0;
  packing.walls.push_back(lid_of(part, axes, 2 * setup.liquid.support()));
  packing.slip.clear();
  packing.vessel.reset();
  packing.follows.reset();
  // The liquid is packed at rest in walls at rest.
  for (particles::BodyPose& pose : poses) pose.v = pose.w = {};
  poses.push_back({{}, Mat3d::identity(), {}, {}});
  const auto engine = make_liquid_engine(packing, true);
  constexpr int steps = spreading.steps + parting.steps;
  std::vector<Vec3d> places = sites;
  for (int round = 1;; ++round) {
    engine->set_state(at_rest_at(places, setup.liquid, part.up, part.surface), poses);
    int done = (round - 1) * steps;
    for (const Packing& phase : {spreading, parting})
      engine->pack(phase, [&](int) {
        ++done;
        if (after_step) after_step(done, round * steps);
      });
    // A particle that has passed a sheet is in the liquid on its other side.
    places = engine->state().position;
    if (engine->figures().passed_walls == 0) return places;
    const std::vector<std::size_t> left = outside(places, part, axes, setup.liquid.spacing);
    if (left.empty()) return places;
    // Where two walls meet, a few of very many particles are squeezed out; through a hole it would be more.
    std::vector<Vec3d> inside = places;
    if (round == most_rounds || left.size() > 1 + places.size() / 100000 ||
        !put_back(inside, left, sites, walls, setup.liquid.spacing))
      refuse_left(places, left);
    places = std::move(inside);
  }
}

}  // namespace

FilledPlaces fill_places(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses,
                         const Filling& filling, const AfterStep& after_step) {
  expect_liquid(setup.liquid);
  const Liquid& l = setup.liquid;
  const FilledPart part = filled_part(l, filling.region, filling.amount);
  const LatticeAxes axes = lattice_axes(part.up, filling.axes);
  Walls walls(setup.walls, l.support());
  for (std::uint32_t b = 0; b < walls.bodies(); ++b) walls.set_pose(b, poses[b]);
  FilledPlaces filled;
  filled.position =
      whole_lattice(part.region, walls, l, {axes, part.level, false}, part.particles, setup.threads);
  if (!filled.position.empty()) {
    const double depth = depth_at_rest(l, part.level - part.low);
    filled.surface = part.low + depth;
    for (Vec3d& x : filled.position) {
      const double height = dot(x, part.up);
      x += (filled.surface - depth_at_rest(l, part.level - height) - height) * part.up;
    }
    return filled;
  }
  filled.position =
      cut_lattice(part.region, walls, l, {axes, part.surface, true}, part.particles, setup.threads);
  refuse_shallow(filled.position, part, axes, l.spacing);
  filled.position = relaxed(setup, poses, walls, part, axes, filled.position, after_step);
  filled.surface = part.surface;
  filled.relaxed = true;
  return filled;
}

LiquidState at_rest_in(const LiquidSetup& setup, const Filling& filling, const std::vector<Vec3d>& places) {
  const FilledPart part = filled_part(setup.liquid, filling.region, filling.amount);
  if (places.size() != part.particles)
    throw Error(
        ErrorCode::protocol,
        std::to_string(places.size()) + " places for " + std::to_string(part.particles) + " particles",
        "fill", "this is a defect of the coordinator");
  return at_rest_at(places, setup.liquid, part.up, part.surface);
}

LiquidState fill_region(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses,
                        const Filling& filling) {
  const FilledPlaces filled = fill_places(setup, poses, filling);
  const Vec3d gravity = setup.liquid.gravity;
  return at_rest_at(filled.position, setup.liquid, -1.0 / norm(gravity) * gravity, filled.surface);
}

}  // namespace tandem::sph
