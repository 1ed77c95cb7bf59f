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

// Whether a point in the frame of the shape is in it.
bool contains(const scene::ParticleSensor& sensor, Vec3d x) {
  if (const auto* box = std::get_if<scene::BoxShape>(&sensor.shape))
    return std::fabs(x.x) <= 0.5 * box->size.x && std::fabs(x.y) <= 0.5 * box->size.y &&
           std::fabs(x.z) <= 0.5 * box->size.z;
  const auto& cylinder = std::get<scene::CylinderShape>(sensor.shape);
  return std::hypot(x.x, x.y) <= cylinder.radius && std::fabs(x.z) <= 0.5 * *cylinder.height;
}

Vec3d velocity_at(const particles::BodyPose& body, Vec3d x) {
  return body.v + cross(body.w, x - body.p);
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

void Sensors::measure_region(const Sensor& sensor, const particles::BodyPose& body, const LiquidState& state,
                             double length, Seen& seen) {
  const scene::LiquidSensor& of = sensor.of;
  const Mat3d own = of.pose.q_WB.matrix();
  const double mass = liquid_.mass();
  Vec3d axis;
  if (of.flow_axis) axis[static_cast<int>(*of.flow_axis)] = 1;
  const Vec3d along = body.R * (own * axis);
  std::uint64_t count = 0;
  double volume = 0, squares = 0, relative = 0;
  Vec3d moment, momentum;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const Vec3d x = state.position[i], v = state.velocity[i];
    const Vec3d in_body = body.R.transpose_times(x - body.p);
    if (!contains(of, own.transpose_times(in_body - of.pose.p_WB))) continue;
    ++count;
    volume += mass / liquid_.density / (1 + state.compression[i]);
    moment += x;
    momentum += v;
    squares += norm2(v);
    relative += dot(along, v - velocity_at(body, x));
  }
  for (const double value : {static_cast<double>(count), static_cast<double>(count) * mass, volume,
                             mass * moment.x, mass * moment.y, mass * moment.z, mass * momentum.x,
                             mass * momentum.y, mass * momentum.z, 0.5 * mass * squares})
    values_.push_back(value);
  if (!of.flow_axis) return;
  const double flow = mass * relative / scene::flow_length(of);
  seen.passed += 0.5 * length * (seen.flow + flow);
  seen.flow = flow;
  if (count > 0)
    seen.longest_way = std::max(seen.longest_way, length * std::abs(relative) / static_cast<double>(count));
  values_.push_back(flow);
  values_.push_back(seen.passed);
}

const std::vector<double>& Sensors::measure(const LiquidState& state,
                                            std::span<const particles::BodyPose> poses, double length,
                                            std::vector<Seen>& seen) {
  for (std::uint32_t w = 0; w < walls_.bodies(); ++w) walls_.set_pose(w, poses[w]);
  const Probe probe(state, liquid_, periods_, walls_);
  values_.clear();
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const Sensor& sensor = sensors_[k];
    const particles::BodyPose body = pose_of(sensor, poses);
    const Vec3d point = body.p + body.R * sensor.of.pose.p_WB;
    switch (sensor.of.kind) {
      case Kind::region:
        measure_region(sensor, body, state, length, seen[k]);
        break;
      case Kind::load: {
        const double per_time = length > 0 ? 1 / length : 0;
        for (const Vec3d& sum : {sensor.force, sensor.torque})
          for (int a = 0; a < 3; ++a) values_.push_back(per_time * sum[a]);
        if (sensor.of.axis) values_.push_back(per_time * sensor.axis_torque);
        break;
      }
      case Kind::level:
        values_.push_back(
            probe.level_on(point, sensor.against_gravity ? *sensor.of.axis : body.R * *sensor.of.axis));
        break;
      case Kind::pressure:
        if (sensor.of.area) {
          const Vec3d inwards = body.R * sensor.of.pose.q_WB.rotate({0, 0, 1});
          values_.push_back(length > 0 ? -dot(sensor.force, inwards) / (length * sensor.area) : 0);
        } else {
          values_.push_back(probe.pressure_at(point));
        }
    }
  }
  return values_;
}

}  // namespace tandem::sph
