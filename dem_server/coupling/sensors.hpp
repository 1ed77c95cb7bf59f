// Sensors of the particles: what is in a region at the end of each window, and what has passed it; and what
// spheres do to a wall.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "dem_server/engine/engine.hpp"

namespace tandem::dem {

class Sensors {
 public:
  // What one sensor keeps from window to window.
  struct Seen {
    double flow = 0, passed = 0;  // at the end of the last window [kg/s], since the start [kg]
    double longest_way = 0;       // of the spheres in the region along its axis, in one window [m]
    bool is_possible() const;
  };

  Sensors() = default;
  // `bodies`: the boundary bodies, in the order of the poses. `wall_rows`: of WindowOutcome::wall_means, for
  // each sensor of a wall.
  Sensors(const scene::Scene& scene, std::span<const BodyId> bodies,
          std::span<const std::uint32_t> wall_rows);

  bool any() const { return !sensors_.empty(); }
  std::vector<Seen> nothing_seen() const { return std::vector<Seen>(sensors_.size()); }
  // A sentence for each sensor whose spheres pass it within a window, so that its `passed` is not right.
  std::vector<std::string> warnings(const std::vector<Seen>& seen) const;
  // The values of scene::sensor_columns() for these poses of the boundary bodies. `length`: of the window
  // that ends now, over which the flow is integrated by the trapezoidal rule [s]. `wall_means`: of that
  // window, empty before the first one.
  const std::vector<double>& measure(Engine& engine, std::span<const BodyPose> poses, double length,
                                     std::span<const double> wall_means, std::vector<Seen>& seen);

 private:
  struct Sensor {
    scene::ParticleSensor of;
    std::size_t body = 0;  // index of its pose; that of the ground may be absent
    bool fixed = false;    // to the ground
    std::size_t row = 0;   // of a sensor of a wall
  };
  std::vector<Sensor> sensors_;
  std::vector<MeasuredRegion> regions_;
  std::vector<double> values_;
};

}  // namespace tandem::dem
