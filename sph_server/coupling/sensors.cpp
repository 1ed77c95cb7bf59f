#include "sph_server/coupling/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "sph_server/engine/probe.hpp"
#include "sph_server/io/patches.hpp"

namespace tandem::sph {
namespace {

using Kind = scene::LiquidSensor::Kind;
using scene::SensorChannel;

}  // namespace

Sensors::Sensors(const scene::Scene& scene, const LiquidSetup& setup, const std::vector<BodyWalls>& walls)
    : liquid_(setup.liquid), periods_(setup.periods) {
  for (const scene::LiquidSensor& of : scene.sph->sensors) {
    Sensor& sensor = sensors_.emplace_back();
    sensor.of = of;
    sensor.channels = scene::channels_of(of);
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (of.wall.empty() ? walls[w].body == of.body : walls[w].sensed == of.wall) {
        sensor.of.body = walls[w].body;
        sensor.wall = w;
        if (of.kind == Kind::load) sensor.walls.push_back(w);
        if (!of.area || walls[w].patch != of.name) continue;
        sensor.walls.push_back(w);
        sensor.area += area_along(walls[w].mesh, of.pose.q_WB.rotate({0, 0, 1}));
      }
    sensor.fixed = sensor.of.body == ground;
    sensor.against_gravity = of.kind == Kind::level && !of.axis;
    if (sensor.against_gravity) sensor.of.axis = -1.0 / norm(scene.gravity) * scene.gravity;
  }
  if (std::ranges::any_of(sensors_, [](const Sensor& s) {
        return s.of.kind == Kind::level || (s.of.kind == Kind::pressure && !s.of.area);
      }))
    walls_ = Walls(setup.walls, setup.liquid.support());
}

std::vector<std::string> Sensors::warnings(const std::vector<particles::FlowRecord>& flows) const {
  std::vector<std::string> sentences;
  for (std::size_t k = 0; k < sensors_.size(); ++k)
    if (const auto sentence = warning_of_flow(sensors_[k].of, flows[k], "liquid"))
      sentences.push_back(*sentence);
  return sentences;
}

particles::BodyPose Sensors::pose_of(const Sensor& sensor, std::span<const particles::BodyPose> poses) const {
  return sensor.fixed ? particles::BodyPose{{}, Mat3d::identity(), {}, {}} : poses[sensor.wall];
}

void Sensors::begin_window() {
  for (Sensor& sensor : sensors_) {
    sensor.force = sensor.torque = {};
    sensor.axis_torque = 0;
  }
}

void Sensors::add_step(double dt, std::span<const Wrench> loads, std::span<const particles::BodyPose> poses) {
  for (Sensor& sensor : sensors_) {
    if (sensor.walls.empty()) continue;
    const particles::BodyPose body = pose_of(sensor, poses);
    Vec3d force, torque;
    for (const std::size_t w : sensor.walls) {
      force += loads[w].force;
      torque += loads[w].torque;
    }
    torque = torque - cross(body.R * sensor.of.pose.p_WB, force);
    sensor.force += dt * force;
    sensor.torque += dt * torque;
    if (sensor.of.axis) sensor.axis_torque += dt * dot(body.R * *sensor.of.axis, torque);
  }
}

particles::SensorValues Sensors::values_of(const Sensor& sensor, const LiquidEngine& engine, double length,
                                           particles::FlowRecord& flow) const {
  const particles::BodyPose body = pose_of(sensor, engine.poses());
  const Vec3d point = body.p + body.R * sensor.of.pose.p_WB;
  // Some more than the probe looks at, which is within the support.
  const double reach = 1.001 * liquid_.support(), per_time = length > 0 ? 1 / length : 0;
  particles::SensorValues values;
  switch (sensor.of.kind) {
    case Kind::region: {
      const particles::RegionSums sums = engine.sums_in(region_of(sensor.of, body));
      flow.add(sensor.of, sums, length);
      values.set_region(sensor.of, sums, flow.passed);
      break;
    }
    case Kind::load:
      values.set(SensorChannel::wall_force_x, per_time * sensor.force);
      values.set(SensorChannel::torque_x, per_time * sensor.torque);
      values.set(SensorChannel::axis_torque, per_time * sensor.axis_torque);
      break;
    case Kind::level: {
      const Vec3d axis = sensor.against_gravity ? *sensor.of.axis : body.R * *sensor.of.axis;
      const LiquidState near = engine.near_line(point, axis, reach);
      values.set(SensorChannel::level, Probe(near, liquid_, periods_, walls_).level_on(point, axis));
      break;
    }
    case Kind::pressure:
      if (sensor.of.area) {
        const Vec3d inwards = body.R * sensor.of.pose.q_WB.rotate({0, 0, 1});
        values.set(SensorChannel::pressure,
                   length > 0 ? -dot(sensor.force, inwards) / (length * sensor.area) : 0);
      } else {
        const LiquidState near = engine.near_line(point, {}, reach);
        values.set(SensorChannel::pressure, Probe(near, liquid_, periods_, walls_).pressure_at(point));
      }
  }
  return values;
}

const std::vector<double>& Sensors::measure(const LiquidEngine& engine, double length,
                                            std::vector<particles::FlowRecord>& flows) {
  for (std::uint32_t w = 0; w < walls_.bodies(); ++w) walls_.set_pose(w, engine.poses()[w]);
  values_.clear();
  for (std::size_t k = 0; k < sensors_.size(); ++k)
    values_of(sensors_[k], engine, length, flows[k]).append_to(values_, sensors_[k].channels);
  return values_;
}

}  // namespace tandem::sph
