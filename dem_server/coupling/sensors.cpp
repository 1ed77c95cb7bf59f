#include "dem_server/coupling/sensors.hpp"

#include <algorithm>

#include "dem_server/contact/wall_sums.hpp"

namespace tandem::dem {

using scene::SensorChannel;

Sensors::Sensors(const scene::Scene& scene, std::span<const BodyId> bodies,
                 std::span<const std::uint32_t> wall_rows) {
  for (const scene::ParticleSensor& of : scene.dem->sensors) {
    Sensor& sensor = sensors_.emplace_back();
    sensor.of = of;
    sensor.channels = scene::channels_of(of);
    if (!of.wall.empty()) {
      sensor.row = wall_rows.front();
      wall_rows = wall_rows.subspan(1);
      continue;
    }
    sensor.body = static_cast<std::size_t>(std::ranges::find(bodies, of.body) - bodies.begin());
    sensor.fixed = of.body == ground;
  }
}

std::vector<std::string> Sensors::warnings(const std::vector<FlowRecord>& flows) const {
  std::vector<std::string> sentences;
  for (std::size_t k = 0; k < sensors_.size(); ++k)
    if (const auto sentence = warning_of_flow(sensors_[k].of, flows[k], "spheres"))
      sentences.push_back(*sentence);
  return sentences;
}

const std::vector<double>& Sensors::measure(Engine& engine, std::span<const BodyPose> poses, double length,
                                            std::span<const double> wall_means,
                                            std::vector<FlowRecord>& flows) {
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
    const Sensor& sensor = sensors_[k];
    SensorValues values;
    if (sensor.of.wall.empty()) {
      flows[k].add(sensor.of, sums[region], length);
      values.set_region(sensor.of, sums[region], flows[k].passed);
      ++region;
    } else {
      const auto mean = [&](WallSum sum) {
        return wall_means.empty() ? 0 : wall_means[sensor.row * wall_sum_count + sum];
      };
      values.set(SensorChannel::wall_force_x, {mean(wall_force_x), mean(wall_force_y), mean(wall_force_z)});
      values.set(SensorChannel::wall_normal_force, mean(wall_normal));
      values.set(SensorChannel::wall_shear_force, mean(wall_shear));
      values.set(SensorChannel::wall_friction_power, mean(wall_friction_work));
    }
    values.append_to(values_, sensor.channels);
  }
  return values_;
}

}  // namespace tandem::dem
