#include "sph_server/coupling/liquid_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "common/scene/particle_file.hpp"
#include "particles/serving/boundary.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/limits.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/io/check_start.hpp"
#include "sph_server/io/coinciding_walls.hpp"
#include "sph_server/io/columns.hpp"
#include "sph_server/io/edges_in_liquid.hpp"
#include "sph_server/io/open_faces.hpp"
#include "sph_server/io/vessel.hpp"
#include "sph_server/io/wall_meshes.hpp"
#include "sph_server/neighbours/neighbour.hpp"
#include "sph_server/neighbours/skin.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

particles::Periods periods_of(const scene::Sph& sph) {
  particles::Periods periods;
  periods.min = sph.domain.min;
  for (int a = 0; a < 3; ++a)
    if (sph.periodic[static_cast<std::size_t>(a)]) periods.length[a] = sph.domain.max[a] - sph.domain.min[a];
  return periods;
}

// speed: of the liquid at the start, relative to the vessel [m/s].
Liquid properties_of(const scene::Sph& sph, Vec3d gravity, double depth, double speed) {
  const scene::Liquid& given = sph.liquids.front();
  Liquid liquid;
  liquid.density = given.density;
  liquid.viscosity = given.viscosity;
  liquid.spacing = sph.spacing;
  liquid.artificial = given.artificial_viscosity;
  liquid.shifting = given.shifting;
  liquid.gravity = gravity;
  speed = std::max(speed, given.expected_speed);
  for (const scene::LiquidInlet& inlet : sph.inlets) speed = std::max(speed, inlet.speed());
  liquid.sound_speed = given.sound_speed.value_or(suggested_sound_speed(speed, norm(gravity), depth));
  return liquid;
}

// In a shorter one a particle would see another one twice, or itself.
void expect_periods(const particles::Periods& periods, const Liquid& liquid) {
  const double least = 3 * (liquid.support() + widest_skin * liquid.spacing);
  for (int a = 0; a < 3; ++a)
    if (periods.length[a] > 0 && periods.length[a] < least)
      throw Error(
          ErrorCode::scene,
          fmt::format("the domain is {:.6g} m long along its periodic axis {}, which is {:.3g} times "
                      "sph.spacing, and a particle must not see another one twice",
                      periods.length[a], "xyz"[a], periods.length[a] / liquid.spacing),
          "sph.domain.periodic",
          fmt::format("give it {:.6g} m or more, or a spacing of {:.3g} m or less; of a slice of a liquid "
                      "that is thinner, walls with free_slip are the sides",
                      least, periods.length[a] / least * liquid.spacing));
}

// Of a speed of sound by rule beyond that of water: a unit is wrong, or the liquid is no longer
// incompressible.
std::optional<std::string> warning_of_speed(const scene::Liquid& given, const Liquid& liquid) {
  constexpr double water = 1500;  // [m/s]
  if (given.sound_speed || liquid.sound_speed <= water) return std::nullopt;
  return fmt::format(
      "sph: the speed of sound of the computation is {:.3g} m/s by rule, more than that of water, since the "
      "liquid of this scene reaches {:.3g} m/s: are velocities in m/s, flows in m3/s and lengths in m?",
      liquid.sound_speed, largest_mach * liquid.sound_speed);
}

// Refuses a given speed of sound that is too low for the liquid as it starts.
void expect_sound_speed(const scene::Liquid& given, const Liquid& liquid, double depth, double speed) {
  if (!given.sound_speed) return;
  const double c = *given.sound_speed;
  const std::string where = "sph.liquids[0].sound_speed";
  const double enough = suggested_sound_speed(speed, norm(liquid.gravity), depth);
  const std::string advice =
      fmt::format("leave it out and give expected_speed, or give {:.3g} m/s or more", enough);
  if (const double compressed = at_rest(liquid, depth).compression;
      given.pressure == scene::StartPressure::hydrostatic && compressed > largest_density_error)
    throw Error(ErrorCode::scene,
                fmt::format("with a speed of sound of {:.3g} m/s the liquid, {:.3g} m deep, is compressed by "
                            "{:.2g} at its bottom by its own weight (limit {:.2g})",
                            c, depth, compressed, largest_density_error),
                where, advice);
  if (speed > largest_mach * c)
    throw Error(ErrorCode::scene,
                fmt::format("the liquid starts with {:.3g} m/s, {:.2g} of the speed of sound of {:.3g} m/s "
                            "(limit {:.2g})",
                            speed, speed / c, c, largest_mach),
                where, advice);
}

}  // namespace

std::size_t LiquidStart::particles() const {
  std::size_t count = sites.position.size();
  for (const FilledInside& filled : insides) count += filled.particles;
  return count;
}

LiquidStart prepare_start(const scene::Scene& scene, const std::vector<NamedMesh>& given) {
  const scene::Sph& sph = scene.sph.value();
  const scene::Liquid& liquid = sph.liquids.front();
  LiquidStart start;
  const std::vector<NamedMesh> meshes = wall_meshes(sph, given, start.coarsened);
  start.walls = walls_of_bodies(scene, meshes);
  start.sites = sites_of(liquid, sph.spacing);
  start.insides = insides_of(scene, meshes);
  for (const BodyWalls& body : start.walls) {
    start.poses.push_back(particles::pose_at_start(body.body, scene));
    start.setup.walls.push_back(body.mesh);
    start.setup.slip.push_back(is_slip(sph, body.body));
  }
  start.inlets = inlets_of(sph);
  for (const Inlet& inlet : start.inlets) {
    start.poses.push_back(inlet.pose(0, 0));
    start.setup.walls.push_back(inlet.piston);
    start.setup.slip.push_back(sph.wall_friction == scene::WallFriction::free_slip);
  }
  check_start(start.sites, scene, start.walls, start.inlets, start.poses);
  check_inlets(start.inlets, start.walls, start.poses, sph.spacing, start.insides,
               start.insides.empty() ? Vec3d{} : -1.0 / norm(scene.gravity) * scene.gravity);
  start.setup.domain = sph.domain;
  if (sph.follows) {
    const auto of = std::ranges::find(start.walls, *sph.follows, &BodyWalls::body);
    start.setup.follows = static_cast<std::uint32_t>(of - start.walls.begin());
    start.setup.follows_from = start.poses[*start.setup.follows].p;
  }
  start.setup.periods = periods_of(sph);
  measure_columns(scene, start.setup, start.poses, start.insides, start.sites);
  start.depth = start.sites.deepest();
  for (const FilledInside& filled : start.insides) start.depth = std::max(start.depth, filled.depth);
  start.vessel = vessel_of(scene, start.walls, start.setup, start.poses, start.sites, start.insides);
  start.setup.vessel = vessel_in(start.walls, start.vessel);
  const Vec3d frame =
      start.setup.vessel ? start.setup.vessel->velocity(start.poses[start.setup.vessel->wall]) : Vec3d{};
  start.velocity = liquid.velocity.value_or(frame);
  const double speed = norm(start.velocity - frame);
  start.setup.liquid = properties_of(sph, scene.gravity, start.depth, speed);
  expect_sound_speed(liquid, start.setup.liquid, start.depth, speed);
  expect_periods(start.setup.periods, start.setup.liquid);
  start.warnings = open_faces(scene, meshes, start.insides, start.setup, start.poses);
  for (std::string& sentence : edges_in_liquid(scene, start.walls, start.poses, start.insides))
    start.warnings.push_back(std::move(sentence));
  for (const scene::LiquidInlet& inlet : sph.inlets)
    if (inlet.start >= scene.end_time)
      start.warnings.push_back(fmt::format(
          "sph: inlet '{}' starts at {} s, so that no liquid comes in before the end at {} s: give an "
          "earlier start or a later end_time",
          inlet.name, inlet.start, scene.end_time));
  if (const auto warning = warning_of_speed(liquid, start.setup.liquid)) start.warnings.push_back(*warning);
  if (!start.inlets.empty()) {
    const Vec3d size = sph.domain.max - sph.domain.min;
    const double filled = size.x * size.y * size.z / (sph.spacing * sph.spacing * sph.spacing);
    start.setup.capacity = static_cast<std::size_t>(std::clamp(filled, 1.0, double{Neighbour::most}));
  }
  return start;
}

PlacesByFill places_in(const std::vector<protocol::NamedText>& files) {
  PlacesByFill places;
  for (const protocol::NamedText& file : files)
    if (file.name.starts_with("sph."))
      places[file.name] = scene::read_particle_file(file.text, file.name).positions;
  return places;
}

LiquidState particles_of(const LiquidStart& start, const scene::Scene& scene, const PlacesByFill& places) {
  LiquidState state =
      liquid_at_start(scene, start.sites, start.insides, start.setup, start.poses, start.velocity, places);
  refuse_coinciding_walls(state.position, start.walls, start.inlets, start.setup, start.poses, scene);
  return state;
}

std::map<BodyId, Wrench> rest_loads_of(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                       const PlacesByFill& places) {
  const LiquidStart start = prepare_start(scene, meshes);
  return loads_at_rest(particles_of(start, scene, places), start.walls, start.setup, start.poses,
                       start.vessel);
}

std::optional<std::string> move_to(const std::map<std::uint32_t, Pose>& poses, const scene::Scene& scene,
                                   LiquidStart& start, LiquidState& liquid) {
  std::vector<particles::BodyPose> now = start.poses;
  particles::BodyPose from{{}, Mat3d::identity(), {}, {}}, to = from;  // of the vessel
  for (std::size_t w = 0; w < start.walls.size(); ++w) {
    const BodyId body = start.walls[w].body;
    if (const auto at = poses.find(body.value); body != ground && at != poses.end())
      now[w] = {at->second.p_WB, at->second.q_WB.matrix(), {}, {}};
    if (body == start.vessel && body != ground) {
      from = start.poses[w];
      to = now[w];
    }
  }
  const auto moved = [&](Vec3d x) { return to.p + to.R * from.R.transpose_times(x - from.p); };
  const double spacing = start.setup.liquid.spacing, support = start.setup.liquid.support();
  std::vector<bool> beside(start.walls.size());
  Walls walls(start.setup.walls, support);
  for (std::uint32_t w = 0; w < walls.bodies(); ++w) walls.set_pose(w, start.poses[w]);
  for (const Vec3d& x : liquid.position)
    walls.view().for_near(x, support, [&](std::uint32_t facet) {
      if (const std::uint32_t w = walls.facets()[facet].body; w < beside.size()) beside[w] = true;
      return true;
    });
  constexpr double most_apart = 0.05;  // spacings: as far as walls are made coarser
  for (std::size_t w = 0; w < start.walls.size(); ++w) {
    if (!beside[w]) continue;
    double apart = 0;
    for (const Vec3d& v : start.setup.walls[w].vertices)
      apart = std::max(apart, norm(now[w].p + now[w].R * v - moved(start.poses[w].p + start.poses[w].R * v)));
    if (apart > most_apart * spacing)
      throw Error(
          ErrorCode::scene,
          fmt::format("in its equilibrium the machine has the wall of '{}' {:.3g} m away from where the "
                      "liquid starts around it (limit {:.3g} m)",
                      scene.body_name(start.walls[w].body), apart, most_apart * spacing),
          "mbd.start",
          "give the bodies in the liquid the positions that they have in the equilibrium, to one another");
  }
  for (Vec3d& x : liquid.position) x = moved(x);
  const Vec3d up = -1.0 / std::max(norm(scene.gravity), 1e-300) * scene.gravity;
  const double tilt = norm(cross(up, to.R * from.R.transpose_times(up)));
  start.poses = now;
  constexpr double visible = 2e-3;  // [rad]
  if (tilt < visible) return std::nullopt;
  return fmt::format(
      "sph: the equilibrium tilts '{}' by {:.2g} rad, and the surface of its liquid with it: the liquid will "
      "slosh. Give the machine that position",
      scene.body_name(start.vessel), tilt);
}

}  // namespace tandem::sph
