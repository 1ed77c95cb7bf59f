#include "sph_server/coupling/sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/sensor_columns.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/io/patches.hpp"

namespace tandem::sph {
namespace {

using Kind = scene::LiquidSensor::Kind;

LiquidRegion region_of(const scene::LiquidSensor& sensor, const particles::BodyPose& body) {
  LiquidRegion region;
  region.centre = body.p + body.R * sensor.pose.p_WB;
  const Mat3d own = sensor.pose.q_WB.matrix();
  for (int a = 0; a < 3; ++a)
    region.axes.row[a] =
        body.R.row[a].x * own.row[0] + body.R.row[a].y * own.row[1] + body.R.row[a].z * own.row[2];
  if (const auto* box = std::get_if<scene::BoxShape>(&sensor.shape)) {
    region.half = 0.5 * box->size;
  } else {
    const auto& cylinder = std::get<scene::CylinderShape>(sensor.shape);
    region.half = {cylinder.radius, cylinder.radius, 0.5 * *cylinder.height};
    region.round = true;
  }
  if (sensor.flow_axis) {
    Vec3d axis;
    axis[static_cast<int>(*sensor.flow_axis)] = 1;
    region.along = region.axes * axis;
  }
  region.body = body;
  return region;
}

}  // namespace

bool Sensors::Seen::is_possible() const {
  return std::isfinite(flow) && std::isfinite(passed) && longest_way >= 0 && std::isfinite(longest_way);
}

Sensors::Sensors(const scene::Scene& scene, const LiquidSetup& setup, const std::vector<BodyWalls>& walls)
    : liquid_(setup.liquid), periods_(setup.periods) {
  for (const scene::LiquidSensor& of : scene.sph->sensors) {
    Sensor& sensor = sensors_.emplace_back();
    sensor.of = of;
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

std::vector<std::string> Sensors::warnings(const std::vector<Seen>& seen) const {
  std::vector<std::string> sentences;
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const scene::LiquidSensor& sensor = sensors_[k].of;
    if (!sensor.flow_axis || !(seen[k].longest_way > scene::flow_length(sensor))) continue;
    sentences.push_back(
        fmt::format("sensor '{}' is {:.4g} m long along its axis, and liquid moved {:.4g} m in one window: "
                    "some passed it unseen, so that its mass passed is not right. Make the region longer, or "
                    "the window shorter",
                    sensor.name, scene::flow_length(sensor), seen[k].longest_way));
  }
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

void Sensors::measure_region(const Sensor& sensor, const particles::BodyPose& body,
                             const LiquidEngine& engine, double length, Seen& seen) {
  const scene::LiquidSensor& of = sensor.of;
  const RegionSums in = engine.sums_in(region_of(of, body));
  for (const double value : {static_cast<double>(in.count), in.mass, in.volume, in.moment.x, in.moment.y,
                             in.moment.z, in.momentum.x, in.momentum.y, in.momentum.z, in.kinetic})
    values_.push_back(value);
  if (!of.flow_axis) return;
  const double flow = in.along / scene::flow_length(of);
  seen.passed += 0.5 * length * (seen.flow + flow);
  seen.flow = flow;
  if (in.count > 0) seen.longest_way = std::max(seen.longest_way, length * std::abs(in.along) / in.mass);
  values_.push_back(flow);
  values_.push_back(seen.passed);
}

const std::vector<double>& Sensors::measure(const LiquidEngine& engine, double length,
                                            std::vector<Seen>& seen) {
  const std::vector<particles::BodyPose>& poses = engine.poses();
  for (std::uint32_t w = 0; w < walls_.bodies(); ++w) walls_.set_pose(w, poses[w]);
  // Some more than the probe looks at, which is within the support.
  const double reach = 1.001 * liquid_.support();
  values_.clear();
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const Sensor& sensor = sensors_[k];
    const particles::BodyPose body = pose_of(sensor, poses);
    const Vec3d point = body.p + body.R * sensor.of.pose.p_WB;
    switch (sensor.of.kind) {
      case Kind::region:
        measure_region(sensor, body, engine, length, seen[k]);
        break;
      case Kind::load: {
        const double per_time = length > 0 ? 1 / length : 0;
        for (const Vec3d& sum : {sensor.force, sensor.torque})
          for (int a = 0; a < 3; ++a) values_.push_back(per_time * sum[a]);
        if (sensor.of.axis) values_.push_back(per_time * sensor.axis_torque);
        break;
      }
      case Kind::level: {
        const Vec3d axis = sensor.against_gravity ? *sensor.of.axis : body.R * *sensor.of.axis;
        const LiquidState near = engine.near_line(point, axis, reach);
        values_.push_back(Probe(near, liquid_, periods_, walls_).level_on(point, axis));
        break;
      }
      case Kind::pressure:
        if (sensor.of.area) {
          const Vec3d inwards = body.R * sensor.of.pose.q_WB.rotate({0, 0, 1});
          values_.push_back(length > 0 ? -dot(sensor.force, inwards) / (length * sensor.area) : 0);
        } else {
          const LiquidState near = engine.near_line(point, {}, reach);
          values_.push_back(Probe(near, liquid_, periods_, walls_).pressure_at(point));
        }
    }
  }
  return values_;
}

}  // namespace tandem::sph
