// Sensors of the liquid: what is in a region, on a line and at a point at the end of each window, and the
// load on walls and the pressure on their areas as means over it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "particles/serving/sensors.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

class Sensors {
 public:
  Sensors() = default;
  // `walls`: those of `setup`, in the same order.
  Sensors(const scene::Scene& scene, const LiquidSetup& setup, const std::vector<BodyWalls>& walls);

  bool any() const { return !sensors_.empty(); }
  // What the sensors keep before the first window, one record for each.
  std::vector<particles::FlowRecord> no_flows() const {
    return std::vector<particles::FlowRecord>(sensors_.size());
  }
  // A sentence for each region that liquid passes within a window, so that its `passed` is not right.
  std::vector<std::string> warnings(const std::vector<particles::FlowRecord>& flows) const;

  void begin_window();
  // The loads on the walls over a step of dt [s] at whose begin they had these poses.
  void add_step(double dt, std::span<const Wrench> loads, std::span<const particles::BodyPose> poses);
  // The values of the columns of sph.sensors. `length`: of the window that ends now [s], 0 at the start.
  const std::vector<double>& measure(const LiquidEngine& engine, double length,
                                     std::vector<particles::FlowRecord>& flows);

 private:
  struct Sensor {
    scene::LiquidSensor of;
    std::vector<scene::SensorChannel> channels;
    std::vector<std::size_t> walls;  // of a load, and in the area of a pressure
    double area = 0;                 // of these walls, along the axis of a pressure [m2]
    std::size_t wall = 0;            // one of its body, for the pose
    bool fixed = false;              // to the ground
    bool against_gravity = false;    // the axis is in the world
    Vec3d force, torque;             // impulses of the window so far [N s], [N m s]
    double axis_torque = 0;          // [N m s]
  };
  particles::BodyPose pose_of(const Sensor& sensor, std::span<const particles::BodyPose> poses) const;
  particles::SensorValues values_of(const Sensor& sensor, const LiquidEngine& engine, double length,
                                    particles::FlowRecord& flow) const;

  std::vector<Sensor> sensors_;
  Liquid liquid_;
  particles::Periods periods_;
  Walls walls_;
  std::vector<double> values_;
};

}  // namespace tandem::sph
