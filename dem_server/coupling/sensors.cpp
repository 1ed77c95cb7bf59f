#include "dem_server/coupling/sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/sensor_columns.hpp"
#include "dem_server/contact/wall_sums.hpp"

namespace tandem::dem {
namespace {

// The sensor's region where its body has this pose.
MeasuredRegion region_of(const scene::ParticleSensor& sensor, const BodyPose& body) {
  const Mat3d own = sensor.pose.q_WB.matrix();
  MeasuredRegion region;
  region.body = body;
  region.p = body.p + body.R * sensor.pose.p_WB;
  for (int column = 0; column < 3; ++column) {
    Vec3d axis;
    axis[column] = 1;
    const Vec3d in_world = body.R * (own * axis);
    for (int row = 0; row < 3; ++row) region.R.row[row][column] = in_world[row];
    if (sensor.flow_axis == static_cast<std::size_t>(column)) region.flow = in_world;
  }
  if (const auto* box = std::get_if<scene::BoxShape>(&sensor.shape)) {
    region.half = 0.5 * box->size;
  } else {
    const auto& cylinder = std::get<scene::CylinderShape>(sensor.shape);
    region.half = {cylinder.radius, cylinder.radius, 0.5 * *cylinder.height};
    region.round = true;
  }
  return region;
}

}  // namespace

bool Sensors::Seen::is_possible() const {
  return std::isfinite(flow) && std::isfinite(passed) && longest_way >= 0 && std::isfinite(longest_way);
}

Sensors::Sensors(const scene::Scene& scene, std::span<const BodyId> bodies,
                 std::span<const std::uint32_t> wall_rows) {
  for (const scene::ParticleSensor& of : scene.dem->sensors) {
    if (!of.wall.empty()) {
      sensors_.push_back({.of = of, .row = wall_rows.front()});
      wall_rows = wall_rows.subspan(1);
      continue;
    }
    const auto found = std::ranges::find(bodies, of.body);
    sensors_.push_back({of, static_cast<std::size_t>(found - bodies.begin()), of.body == ground});
  }
}

std::vector<std::string> Sensors::warnings(const std::vector<Seen>& seen) const {
  std::vector<std::string> sentences;
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const scene::ParticleSensor& sensor = sensors_[k].of;
    if (!sensor.flow_axis || !(seen[k].longest_way > scene::flow_length(sensor))) continue;
    sentences.push_back(
        fmt::format("sensor '{}' is {:.4g} m long along its axis, and spheres moved {:.4g} m in one window: "
                    "some passed it unseen, so that "
                    "its mass passed is not right. Make the region longer, or the window shorter",
                    sensor.name, scene::flow_length(sensor), seen[k].longest_way));
  }
  return sentences;
}

const std::vector<double>& Sensors::measure(Engine& engine, std::span<const BodyPose> poses, double length,
                                            std::span<const double> wall_means, std::vector<Seen>& seen) {
  const BodyPose at_origin{.p = {}, .R = Quat{}.matrix(), .v = {}, .w = {}};
  regions_.clear();
  for (const Sensor& sensor : sensors_)
    if (sensor.of.wall.empty())
      regions_.push_back(region_of(sensor.of, sensor.fixed ? at_origin : poses[sensor.body]));
  const std::vector<RegionSums> none;
  const std::vector<RegionSums>& sums = regions_.empty() ? none : engine.measure(regions_);
  std::size_t region = 0;
  values_.clear();
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const scene::ParticleSensor& sensor = sensors_[k].of;
    if (!sensor.wall.empty()) {
      for (std::size_t c = wall_force_x; c <= wall_friction_work; ++c)
        values_.push_back(wall_means.empty() ? 0 : wall_means[sensors_[k].row * wall_sum_count + c]);
      continue;
    }
    const RegionSums& sum = sums[region++];
    for (const double value :
         {static_cast<double>(sum.count), sum.mass, sum.volume, sum.volume / scene::volume_of(sensor),
          sum.moment.x, sum.moment.y, sum.moment.z, sum.momentum.x, sum.momentum.y, sum.momentum.z,
          sum.kinetic_energy})
      values_.push_back(value);
    if (!sensor.flow_axis) continue;
    const double flow = sum.flow_momentum / scene::flow_length(sensor);
    seen[k].passed += 0.5 * length * (seen[k].flow + flow);
    seen[k].flow = flow;
    if (sum.mass > 0)
      seen[k].longest_way = std::max(seen[k].longest_way, length * std::abs(sum.flow_momentum) / sum.mass);
    values_.push_back(flow);
    values_.push_back(seen[k].passed);
  }
  return values_;
}

}  // namespace tandem::dem
