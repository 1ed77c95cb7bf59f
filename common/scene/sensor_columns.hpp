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
// Of a region: as above, without the solid fraction. Of a load: force and torque, and the torque about an
// axis where it has one.
std::vector<SensorChannel> channels_of(const LiquidSensor& sensor);

// Without "time": those of dem.sensors, then those of sph.sensors. The values of each solver travel in this
// order (protocol::LoadSet). Empty without any.
std::vector<std::string> sensor_columns(const Scene& scene);

// Calls each(name of the sensor, its channels) in the order of the columns.
template <class Each>
void each_sensor(const Scene& scene, Each each) {
  if (scene.dem)
    for (const ParticleSensor& sensor : scene.dem->sensors) each(sensor.name, channels_of(sensor));
  if (scene.sph)
    for (const LiquidSensor& sensor : scene.sph->sensors) each(sensor.name, channels_of(sensor));
}

double volume_of(const ParticleSensor& sensor);  // [m3]
// Extent of the region along its axis of flow [m].
double flow_length(const ParticleSensor& sensor);

// The table of docs/results.md.
std::string sensor_channels_as_markdown();

}  // namespace tandem::scene
