// What the sensors of all particle solvers have in common: regions on bodies, the mass that passes them, and
// values with names.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/sensor_columns.hpp"
#include "particles/geometry/region.hpp"

namespace tandem::particles {

// The region of a sensor whose body has this pose.
MeasuredRegion region_of(const scene::ParticleSensor& sensor, const BodyPose& body);

// The region of an outlet, of a domain that has moved by `shift` [m].
OutletRegion region_of(const scene::Outlet& outlet, Vec3d shift);

// The values of one sensor, by channel.
class SensorValues {
 public:
  void set(scene::SensorChannel channel, double value) { values_[static_cast<std::size_t>(channel)] = value; }
  // Sets the channels of x, y and z.
  void set(scene::SensorChannel x, Vec3d value);
  // The values of a region. `passed`: through it so far [kg].
  void set_region(const scene::ParticleSensor& sensor, const RegionSums& sums, double passed);

  // Appends the value of each channel, in this order. Error{internal} where one has not been set.
  void append_to(std::vector<double>& values, const std::vector<scene::SensorChannel>& channels) const;

 private:
  std::array<std::optional<double>, static_cast<std::size_t>(scene::SensorChannel::channels)> values_;
};

// The mass that passes a region. Part of a solver's state; numbers only, without gaps.
struct FlowRecord {
  double flow = 0, passed = 0;  // at the end of the last window [kg/s], since the start [kg]
  double longest_way = 0;       // of the particles in the region along its axis, in one window [m]

  bool is_possible() const;
  // At the end of a window of `length` [s], over which the flow is integrated by the trapezoidal rule.
  void add(const scene::ParticleSensor& sensor, const RegionSums& sums, double length);
};

// A sentence where `what`, "spheres" or "liquid", passes the sensor within a window, so that its mass passed
// is wrong.
std::optional<std::string> warning_of_flow(const scene::ParticleSensor& sensor, const FlowRecord& record,
                                           const char* what);

}  // namespace tandem::particles
