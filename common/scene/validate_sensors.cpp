// Sensors of spheres and of the liquid.
#include <algorithm>
#include <cmath>

#include "common/scene/element_columns.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

// Whether a column of a body, a joint or an element begins with this name.
bool names_something_else(const std::string& name, const Scene& scene) {
  // `time` begins each row, and `summary` the names of the numbers of the summary.
  if (name == scene.body_name(ground) || name == "time" || name == "summary") return true;
  if (!scene.mbd) return false;
  const auto is_it = [&](const auto& named) { return named.name == name; };
  return std::ranges::any_of(scene.mbd->bodies, is_it) || std::ranges::any_of(scene.mbd->joints, is_it) ||
         std::ranges::any_of(elements_of(scene), is_it);
}

double bounding_radius(const ParticleSensor& sensor) {
  if (const auto* box = std::get_if<BoxShape>(&sensor.shape)) return 0.5 * norm(box->size);
  const auto& cylinder = std::get<CylinderShape>(sensor.shape);
  return std::hypot(cylinder.radius, 0.5 * *cylinder.height);
}

void require_own_name(const ParticleSensor& sensor, const char* suffix, const Scene& scene,
                      const std::string& origin, const std::string& path) {
  if (names_something_else(sensor.name, scene))
    fail(origin, path + ".name",
         "a body, joint, element or part of the results is called '" + sensor.name +
             "' as well, so that columns would be mixed up",
         "give the sensor another name, such as '" + sensor.name + suffix + "'");
}

void require_walls_on(BodyId body, const std::vector<Wall>& walls, const Scene& scene,
                      const std::string& origin, const std::string& path) {
  if (body != ground && std::ranges::none_of(walls, [&](const Wall& wall) { return wall.body == body; }))
    fail(origin, path + ".body", "the body '" + scene.body_name(body) + "' carries no wall",
         "the particles know where bodies with walls are: name one of those");
}

void require_region(const ParticleSensor& sensor, const std::string& origin, const std::string& path) {
  require_unit(sensor.pose.q_WB, origin, path + ".orientation");
  if (std::holds_alternative<CylinderShape>(sensor.shape) && sensor.flow_axis && *sensor.flow_axis != 2)
    fail(origin, path + ".flow", "a cylinder has different lengths along x and y, so that no flow follows",
         "measure along its axis, z, or give a box");
}

// Refuses what is on the ground and farther from the domain than `radius`. `what`: "the region", `who`: what
// is in the domain only.
void require_in_domain(const ParticleSensor& sensor, double radius, const Box& domain, const char* list,
                       const char* what, const char* who, const std::string& origin,
                       const std::string& path) {
  double distance2 = 0;  // of the domain from the position of the sensor
  for (int a = 0; a < 3; ++a) {
    const double x = sensor.pose.p_WB[a], beyond = std::max({domain.min[a] - x, x - domain.max[a], 0.0});
    distance2 += beyond * beyond;
  }
  if (std::sqrt(distance2) > radius)
    fail(origin, path + ".position",
         std::string(what) + " at " + text(sensor.pose.p_WB) + " lies outside " + list +
             ".domain, where no " + who + " is",
         "move it into the domain");
}

}  // namespace

void validate_particle_sensors(const Scene& scene, const std::string& origin) {
  const Dem& dem = *scene.dem;
  for (std::size_t i = 0; i < dem.sensors.size(); ++i) {
    const ParticleSensor& sensor = dem.sensors[i];
    const std::string path = element("dem.sensors", i);
    require_own_name(sensor, sensor.wall.empty() ? "_content" : "_load", scene, origin, path);
    if (!sensor.wall.empty()) {
      require_wall(sensor.wall, dem.walls, origin, path + ".wall");
      continue;
    }
    require_region(sensor, origin, path);
    require_walls_on(sensor.body, dem.walls, scene, origin, path);
    if (sensor.body == ground && !dem.follows)
      require_in_domain(sensor, bounding_radius(sensor), dem.domain, "dem", "the region", "sphere", origin,
                        path);
  }
}

void validate_liquid_sensors(const Scene& scene, const std::string& origin) {
  using Kind = LiquidSensor::Kind;
  const Sph& sph = *scene.sph;
  for (std::size_t i = 0; i < sph.sensors.size(); ++i) {
    const LiquidSensor& sensor = sph.sensors[i];
    const std::string path = element("sph.sensors", i);
    require_own_name(sensor, sensor.kind == Kind::load ? "_load" : "_content", scene, origin, path);
    if (scene.dem &&
        std::ranges::find(scene.dem->sensors, sensor.name, &ParticleSensor::name) != scene.dem->sensors.end())
      fail(origin, path + ".name", "a sensor of dem.sensors is called '" + sensor.name + "' as well",
           "give one of them another name");
    if (sensor.axis) require_unit(*sensor.axis, origin, path + ".axis");
    if (!sensor.wall.empty()) {
      require_wall(sensor.wall, sph.walls, origin, path + ".wall");
      continue;
    }
    require_walls_on(sensor.body, sph.walls, scene, origin, path);
    if (sensor.kind == Kind::load) {
      if (std::ranges::none_of(sph.walls, [&](const Wall& wall) { return wall.body == sensor.body; }))
        fail(origin, path, "there is no wall of the liquid on '" + scene.body_name(sensor.body) + "'",
             "name a wall, or a body that has one");
      continue;
    }
    if (sensor.kind == Kind::region) require_region(sensor, origin, path);
    if (sensor.kind == Kind::level && !sensor.axis && norm(scene.gravity) == 0)
      fail(origin, path, "no line follows: there is no gravity against which a level would be measured",
           "give an axis");
    if (sensor.body == ground && !sph.follows)
      require_in_domain(sensor, sensor.kind == Kind::region ? bounding_radius(sensor) : 0, sph.domain, "sph",
                        sensor.kind == Kind::region ? "the region" : "the point", "liquid", origin, path);
  }
}

}  // namespace tandem::scene
