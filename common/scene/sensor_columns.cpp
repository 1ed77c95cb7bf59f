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

std::vector<SensorChannel> channels_of(const ParticleSensor& sensor) {
  std::vector<SensorChannel> channels;
  const bool of_wall = !sensor.wall.empty();
  const auto begin = of_wall ? SensorChannel::wall_force_x : SensorChannel::count;
  const auto end = of_wall            ? SensorChannel::channels
                   : sensor.flow_axis ? SensorChannel::wall_force_x
                                      : SensorChannel::flow;
  for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
    channels.push_back(static_cast<SensorChannel>(c));
  return channels;
}

std::vector<std::string> sensor_columns(const Scene& scene) {
  std::vector<std::string> columns;
  if (!scene.dem) return columns;
  for (const ParticleSensor& sensor : scene.dem->sensors)
    for (const SensorChannel channel : channels_of(sensor))
      columns.push_back(sensor.name + "." + name(channel));
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
