#include "common/scene/sensor_columns.hpp"

#include <cstddef>
#include <numbers>

namespace tandem::scene {
namespace {

struct SensorChannelFacts {
  const char *name, *unit, *meaning;
};
constexpr SensorChannelFacts sensor_channels[] = {
#define SENSOR_CHANNEL(identifier, name, unit, meaning) {name, unit, meaning},
#include "common/scene/sensor_channels.def"
#undef SENSOR_CHANNEL
};

}  // namespace

const char* name(SensorChannel channel) {
  return sensor_channels[static_cast<std::size_t>(channel)].name;
}
const char* unit(SensorChannel channel) {
  return sensor_channels[static_cast<std::size_t>(channel)].unit;
}

namespace {

void append(SensorChannel first, SensorChannel last, std::vector<SensorChannel>& to) {
  for (auto c = static_cast<std::size_t>(first); c <= static_cast<std::size_t>(last); ++c)
    to.push_back(static_cast<SensorChannel>(c));
}

}  // namespace

std::vector<SensorChannel> channels_of(const ParticleSensor& sensor) {
  std::vector<SensorChannel> channels;
  if (!sensor.wall.empty())
    append(SensorChannel::wall_force_x, SensorChannel::wall_friction_power, channels);
  else
    append(SensorChannel::count, sensor.flow_axis ? SensorChannel::passed : SensorChannel::kinetic_energy,
           channels);
  return channels;
}

std::vector<SensorChannel> channels_of(const LiquidSensor& sensor) {
  std::vector<SensorChannel> channels;
  switch (sensor.kind) {
    case LiquidSensor::Kind::region:
      channels = channels_of(static_cast<const ParticleSensor&>(sensor));
      std::erase(channels, SensorChannel::solid_fraction);
      break;
    case LiquidSensor::Kind::load:
      append(SensorChannel::wall_force_x, SensorChannel::wall_force_z, channels);
      append(SensorChannel::torque_x, sensor.axis ? SensorChannel::axis_torque : SensorChannel::torque_z,
             channels);
      break;
    case LiquidSensor::Kind::level:
      channels = {SensorChannel::level};
      break;
    case LiquidSensor::Kind::pressure:
      channels = {SensorChannel::pressure};
  }
  return channels;
}

std::vector<std::string> sensor_columns(const Scene& scene) {
  std::vector<std::string> columns;
  each_sensor(scene, [&](const std::string& sensor, const std::vector<SensorChannel>& channels) {
    for (const SensorChannel channel : channels) columns.push_back(sensor + "." + name(channel));
  });
  return columns;
}

double volume_of(const ParticleSensor& sensor) {
  if (const auto* box = std::get_if<BoxShape>(&sensor.shape)) return box->size.x * box->size.y * box->size.z;
  const auto& cylinder = std::get<CylinderShape>(sensor.shape);
  return std::numbers::pi * cylinder.radius * cylinder.radius * cylinder.height.value();
}

double flow_length(const ParticleSensor& sensor) {
  if (const auto* box = std::get_if<BoxShape>(&sensor.shape))
    return box->size[static_cast<int>(sensor.flow_axis.value())];
  return std::get<CylinderShape>(sensor.shape).height.value();
}

std::string sensor_channels_as_markdown() {
  std::string table = "| channel | unit | meaning |\n|---|---|---|\n";
  for (const SensorChannelFacts& row : sensor_channels)
    table += std::string("| `") + row.name + "` | " + row.unit + " | " + row.meaning + " |\n";
  return table;
}

}  // namespace tandem::scene
