// Sensors of the particles: what is in a region at the end of each window, and what has passed it; and what
// spheres do to a wall.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "dem_server/engine/engine.hpp"
#include "particles/serving/sensors.hpp"

namespace tandem::dem {

class Sensors {
 public:
  Sensors() = default;
  // `bodies`: the boundary bodies, in the order of the poses. `wall_rows`: of WindowOutcome::wall_means, for
  // each sensor of a wall.
  Sensors(const scene::Scene& scene, std::span<const BodyId> bodies,
          std::span<const std::uint32_t> wall_rows);

  bool any() const { return !sensors_.empty(); }
  // What the sensors keep before the first window, one record for each.
  std::vector<FlowRecord> no_flows() const { return std::vector<FlowRecord>(sensors_.size()); }
  // A sentence for each sensor whose spheres pass it within a window, so that its `passed` is not right.
  std::vector<std::string> warnings(const std::vector<FlowRecord>& flows) const;
  // The values of the columns of dem.sensors for these poses of the boundary bodies. `length`: of the window
  // that ends now [s]. `wall_means`: of that window, empty before the first one.
  const std::vector<double>& measure(Engine& engine, std::span<const BodyPose> poses, double length,
                                     std::span<const double> wall_means, std::vector<FlowRecord>& flows);

 private:
  struct Sensor {
    scene::ParticleSensor of;
    std::vector<scene::SensorChannel> channels;
    std::size_t body = 0;  // index of its pose; that of the ground may be absent
    bool fixed = false;    // to the ground
    std::size_t row = 0;   // of a sensor of a wall
  };
  std::vector<Sensor> sensors_;
  std::vector<MeasuredRegion> regions_;
  std::vector<double> values_;
};

}  // namespace tandem::dem
