#include "coordinator/scene/settle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "common/log.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/parse.hpp"
#include "coordinator/scene/scene_spheres.hpp"
#include "coordinator/scene/unsettled.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "particles/io/fill.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

// Share of the energy of a fall through the smallest radius that the bound may be [-].
constexpr double largest_bound_share = 0.1;
// Windows in the time of a fall through the largest radius.
constexpr int windows_of_fall = 4;
constexpr double seconds_between_lines = 5;

// Bodies at rest have no part in the settling but their poses. Their masses must be numbers.
Json body_at_rest(const Json& body) {
  Json at_rest = {{"name", body.at("name")}, {"mass", 1}, {"inertia", {1, 1, 1}}};
  for (const char* key : {"position", "orientation"})
    if (body.contains(key)) at_rest[key] = body[key];
  return at_rest;
}

// Energy of a fall through the radius, of the sphere for which it is least [J].
double least_fall(const particles::Fill& fill, const scene::Scene& scene) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < fill.radius.size(); ++i) {
    const double r = fill.radius[i];
    const double mass = scene.dem->materials[fill.material[i]].density * 4 / 3 * std::numbers::pi * r * r * r;
    least = std::min(least, mass * norm(scene.gravity) * r);
  }
  return least;
}

protocol::MotionSet at_rest(const scene::Scene& scene) {
  protocol::MotionSet motion;
  std::vector<bool> has_wall(scene.mbd ? scene.mbd->bodies.size() : 0);
  for (const scene::Wall& wall : scene.dem->walls)
    if (wall.body != ground) has_wall[wall.body.value] = true;
  for (std::uint32_t b = 0; b < has_wall.size(); ++b) {
    if (!has_wall[b]) continue;
    protocol::BodyMotion& body = motion.bodies.emplace_back();
    body.body = b;
    body.begin_pose = body.end_pose = scene.mbd->bodies[b].pose;
  }
  return motion;
}

// The spheres of each group. None has left: they are in the order of the fill.
Settled spheres_in(const protocol::ParticlesFrame& frame, const particles::Fill& fill,
                   const scene::Scene& scene) {
  Settled settled;
  const auto row = [](const auto& values, std::size_t i) {
    return Vec3d{values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  };
  for (std::size_t i = 0; i < fill.radius.size(); ++i) {
    if (i == 0 || fill.group[i] != fill.group[i - 1]) {
      settled.groups.push_back(scene.dem->particles[fill.group[i]].name);
      settled.spheres.emplace_back();
    }
    scene::ParticleFile& group = settled.spheres.back();
    group.positions.push_back(row(frame.position, i));
    group.radii.push_back(fill.radius[i]);
    group.velocities.push_back(row(frame.velocity, i));
    group.spins.push_back(row(frame.spin, i));
  }
  return settled;
}

// The first sphere of `before` that is no longer there, and the face of the domain that is nearest to where
// it was going: "the first is sphere 3 of 'grains', last seen at (0, 0, -0.1) m, near the face z = -0.2 m".
std::string where_it_left(const protocol::ParticlesFrame& before, const protocol::ParticlesFrame& now,
                          const particles::Fill& fill, const scene::Scene& scene) {
  for (std::size_t i = 0; i < before.id.size(); ++i) {
    const std::uint32_t id = before.id[i];
    if (std::ranges::binary_search(now.id, id)) continue;
    const double ahead = to_seconds(now.time - before.time);
    const scene::Box& domain = scene.dem->domain;
    Vec3d place;
    int axis = 0;
    bool upper = false;
    double nearest = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      place[a] = before.position[3 * i + static_cast<std::size_t>(a)];
      const double next = place[a] +
                          ahead * static_cast<double>(before.velocity[3 * i + static_cast<std::size_t>(a)]) +
                          0.5 * ahead * ahead * scene.gravity[a];
      for (const bool high : {false, true})
        if (const double gap = high ? domain.max[a] - next : next - domain.min[a]; gap < nearest)
          nearest = gap, axis = a, upper = high;
    }
    return fmt::format("; the first is sphere {} of '{}', last seen at {} m, near the face {} = {:.6g} m", id,
                       scene.dem->particles[fill.group[id]].name, scene::rounded(place), "xyz"[axis],
                       (upper ? domain.max : domain.min)[axis]);
  }
  return {};
}

// ". They are drawn in NAME_unsettled.png", or why they are not.
std::string picture_of(const Unsettled& unsettled, const std::filesystem::path& picture) {
  if (picture.empty()) return {};
  try {
    draw_unsettled(picture, unsettled);
    return ". They are drawn in " + picture.string();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) throw;
    return ". They are not drawn in " + picture.string() + ": " + error.problem();
  }
}

}  // namespace

std::string settling_scene(const std::string& text) {
  const Json given = Json::parse(text);
  Json scene;
  for (const char* key : {"tandem", "gravity"})
    if (given.contains(key)) scene[key] = given[key];
  scene["name"] = "settling";
  scene["end_time"] = 1;  // the windows that are sent end the settling
  scene["output"] = {{"particles", false}};
  if (given.contains("mbd")) {
    Json& bodies = scene["mbd"]["bodies"] = Json::array();
    for (const Json& body : given["mbd"]["bodies"]) bodies.push_back(body_at_rest(body));
  }
  Json& dem = scene["dem"] = given.at("dem");
  for (const char* key :
       {"settle", "server", "solver_options", "outlets", "sensors", "overlap_limit", "speed_limit"})
    dem.erase(key);
  Json groups = Json::array();
  for (const Json& group : dem["particles"])
    if (group["fill"]["type"] != "inlet") groups.push_back(group);
  dem["particles"] = std::move(groups);
  if (dem.contains("walls"))
    for (Json& wall : dem["walls"])
      for (const char* key : {"surface_velocity", "color"}) wall.erase(key);
  return scene.dump();
}

Settled settle(const SceneFile& file, const scene::Settle& settle, const SettleOn& on) {
  const std::string where = file.origin + ": dem.settle", text = settling_scene(file.text);
  scene::Scene scene = scene::parse(text, file.origin);
  const particles::Fill fill = particles::make_fill(scene, particles_in(file));
  const auto spheres = static_cast<double>(fill.radius.size());
  if (const double most = largest_bound_share * least_fall(fill, scene); settle.kinetic_energy > most)
    throw Error(
        ErrorCode::scene,
        fmt::format("the kinetic_energy of {:.4g} J does not tell a bed at rest from falling spheres: "
                    "a fall through its radius gives the lightest sphere {:.4g} J",
                    settle.kinetic_energy, most / largest_bound_share),
        where, fmt::format("give at most a tenth of that, {:.4g} J", most));
  const double fall = std::sqrt(2 * *std::ranges::max_element(fill.radius) / norm(scene.gravity)),
               window = std::max(1e-9, std::round(fall / windows_of_fall * 1e9) / 1e9);
  Json timed = Json::parse(text);
  timed["coupling"]["window"] = window;
  const protocol::Configuration configuration{timed.dump(), file.origin, file.meshes,
                                              file.files,   on.backend,  on.threads};
  const std::unique_ptr<protocol::LoadSolver> solver = dem::make_solver();
  log::info("{} spheres settle until their mean kinetic energy is below {:.4g} J", fill.radius.size(),
            settle.kinetic_energy);
  try {
    solver->configure(configuration);
    protocol::MotionSet motion = at_rest(scene);
    auto last_line = std::chrono::steady_clock::now();
    double energy = 0;
    int quiet = 0;
    protocol::ParticlesFrame earlier;  // about a fall through the largest radius ago
    while (to_seconds(motion.window.end) < settle.at_most) {
      motion.window = {motion.window.index + (motion.window.end.count > 0 ? 1 : 0), motion.window.end,
                       Nanoseconds{motion.window.end.count + std::llround(window * 1e9)}};
      const protocol::ParticleAccount& account = solver->advance(motion).account;
      const double time = to_seconds(motion.window.end);
      if (account.lost_particles > 0) {
        const protocol::ParticlesFrame now = solver->observe();
        const Unsettled unsettled{file, scene, fill, earlier, settle.kinetic_energy};
        throw Error(ErrorCode::scene,
                    fmt::format("{} spheres have left the domain by t = {:.4g} s of settling{}{}",
                                account.lost_particles, time, where_it_left(earlier, now, fill, scene),
                                picture_of(unsettled, on.picture)),
                    where, "close the container for the start, or enlarge dem.domain");
      }
      if (motion.window.index % windows_of_fall == 0) earlier = solver->observe();
      energy = account.kinetic_energy / spheres;
      quiet = energy < settle.kinetic_energy ? quiet + 1 : 0;
      if (quiet > windows_of_fall) {
        Settled settled = spheres_in(solver->observe(), fill, scene);
        settled.time = time;
        settled.kinetic_energy = energy;
        return settled;
      }
      if (const auto now = std::chrono::steady_clock::now();
          std::chrono::duration<double>(now - last_line).count() > seconds_between_lines) {
        log::info("settling: t = {:.4g} s, mean kinetic energy {:.4g} J", time, energy);
        last_line = now;
      }
    }
    const Unsettled unsettled{file, scene, fill, solver->observe(), settle.kinetic_energy};
    throw Error(
        ErrorCode::scene,
        fmt::format("the spheres have not settled after {:.4g} s: their mean kinetic energy is {:.4g} "
                    "J, and kinetic_energy is {:.4g} J{}{}",
                    settle.at_most, energy, settle.kinetic_energy, what_moves(unsettled),
                    picture_of(unsettled, on.picture)),
        where, "give more time as at_most, or a larger kinetic_energy");
  } catch (const Error& error) {
    if (error.where() == where) throw;
    throw Error(error.code(), error.problem() + " while the spheres settled", error.where(), error.hint());
  }
}

}  // namespace tandem::launch
