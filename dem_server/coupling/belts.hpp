// Conveyor belts: walls whose surfaces move along themselves, with the work that their drives do.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/scene/motion_function.hpp"
#include "dem_server/engine/engine.hpp"

namespace tandem::dem {

class Belts {
 public:
  // Work that the drive of one belt has done on the spheres, and the largest mean power of a window.
  struct Record {
    double work = 0, power = 0, largest_power = 0;  // [J], of the last window [W], by size [W]
    bool is_possible() const;
  };

  Belts() = default;
  Belts(const scene::Scene& scene, const Surface& surface);

  bool any() const { return !belts_.empty(); }
  std::vector<Record> no_records() const { return std::vector<Record>(belts_.size()); }
  // Bound of the speed of any belt until `end_time` [m/s].
  double largest_speed(double end_time) const;

  // Velocities in a window that begins at `begin` [s], as WindowPlan::belt_velocity has them. In a micro step
  // they are those of half a step before, as for bodies.
  std::span<const Vec3d> velocities(double begin, std::uint32_t steps, double dt);
  // Velocity of the surface of a boundary body at that time, in the body's frame [m/s].
  Vec3d velocity(std::size_t body, double time) const;
  void record(const WindowOutcome& outcome, const WindowPlan& plan, std::vector<Record>& records) const;
  void report(const std::vector<Record>& records, nlohmann::ordered_json& others) const;

 private:
  struct Belt {
    std::size_t body;  // boundary body index
    std::string name;
    Vec3d direction;  // in the body's frame
    scene::MotionFunction speed;
  };
  std::vector<Belt> belts_;
  std::size_t bodies_ = 0;
  std::vector<Vec3d> velocity_;
};

}  // namespace tandem::dem
