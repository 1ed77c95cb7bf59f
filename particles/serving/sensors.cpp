#include "particles/serving/sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::particles {

using scene::SensorChannel;

MeasuredRegion region_of(const scene::ParticleSensor& sensor, const BodyPose& body) {
  MeasuredRegion region;
  region.body = body;
  region.p = body.p + body.R * sensor.pose.p_WB;
  const Mat3d own = sensor.pose.q_WB.matrix();
  for (int a = 0; a < 3; ++a)
    region.R.row[a] =
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
    region.flow = region.R * axis;
  }
  return region;
}

OutletRegion region_of(const scene::Outlet& outlet, Vec3d shift) {
  if (const auto* beyond = std::get_if<scene::HalfSpace>(&outlet.region))
    return {beyond->point + shift, {}, beyond->normal, true};
  const auto& box = std::get<scene::Box>(outlet.region);
  return {box.min + shift, box.max + shift, {}, false};
}

void SensorValues::set(SensorChannel x, Vec3d value) {
  for (int a = 0; a < 3; ++a) values_[static_cast<std::size_t>(x) + static_cast<std::size_t>(a)] = value[a];
}

void SensorValues::set_region(const scene::ParticleSensor& sensor, const RegionSums& sums, double passed) {
  set(SensorChannel::count, static_cast<double>(sums.count));
  set(SensorChannel::mass, sums.mass);
  set(SensorChannel::volume, sums.volume);
  set(SensorChannel::solid_fraction, sums.volume / scene::volume_of(sensor));
  set(SensorChannel::moment_x, sums.moment);
  set(SensorChannel::momentum_x, sums.momentum);
  set(SensorChannel::kinetic_energy, sums.kinetic_energy);
  if (!sensor.flow_axis) return;
  set(SensorChannel::flow, sums.flow_momentum / scene::flow_length(sensor));
  set(SensorChannel::passed, passed);
}

void SensorValues::append_to(std::vector<double>& values, const std::vector<SensorChannel>& channels) const {
  for (const SensorChannel channel : channels) {
    const std::optional<double>& value = values_[static_cast<std::size_t>(channel)];
    if (!value)
      throw Error(ErrorCode::internal, fmt::format("the channel '{}' has no value", name(channel)),
                  "sensors");
    values.push_back(*value);
  }
}

bool FlowRecord::is_possible() const {
  return std::isfinite(flow) && std::isfinite(passed) && longest_way >= 0 && std::isfinite(longest_way);
}

void FlowRecord::add(const scene::ParticleSensor& sensor, const RegionSums& sums, double length) {
  if (!sensor.flow_axis) return;
  const double now = sums.flow_momentum / scene::flow_length(sensor);
  passed += 0.5 * length * (flow + now);
  flow = now;
  if (sums.mass > 0) longest_way = std::max(longest_way, length * std::abs(sums.flow_momentum) / sums.mass);
}

std::optional<std::string> warning_of_flow(const scene::ParticleSensor& sensor, const FlowRecord& record,
                                           const char* what) {
  if (!sensor.flow_axis || !(record.longest_way > scene::flow_length(sensor))) return {};
  return fmt::format(
      "sensor '{}' is {:.4g} m long along its axis, and {} moved {:.4g} m in one window: some passed it "
      "between two measurements, so that its mass passed is not right. Make the region longer, or the window "
      "shorter",
      sensor.name, scene::flow_length(sensor), what, record.longest_way);
}

}  // namespace tandem::particles
