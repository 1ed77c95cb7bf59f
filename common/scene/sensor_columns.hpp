// What the sensors of a scene measure of its particles and walls: the columns SENSOR.CHANNEL of sensors.csv.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

enum class SensorChannel {
#define SENSOR_CHANNEL(identifier, name, unit, meaning) identifier,
#include "common/scene/sensor_channels.def"
#undef SENSOR_CHANNEL
  channels
};
const char* name(SensorChannel channel);
const char* unit(SensorChannel channel);

// Those of a wall, or those of a region, without flow and passed where it has no axis of flow.
std::vector<SensorChannel> channels_of(const ParticleSensor& sensor);

// Without "time". The values travel in this order (protocol::LoadSet). Empty without any.
std::vector<std::string> sensor_columns(const Scene& scene);

double volume_of(const ParticleSensor& sensor);  // [m3]
// Extent of the region along its axis of flow [m].
double flow_length(const ParticleSensor& sensor);

// The table of docs/results.md.
std::string sensor_channels_as_markdown();

}  // namespace tandem::scene
