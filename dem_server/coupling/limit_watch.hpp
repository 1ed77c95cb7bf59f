// Looks at each window of a run: is the micro step short enough for the collisions that happen, and do
// overlaps and speeds stay within the limits of the scene? It stops nothing: it warns once of each, and
// counts windows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/state/particles.hpp"

namespace tandem::dem {

class LimitWatch {
 public:
  LimitWatch() = default;
  LimitWatch(const scene::Dem& dem, const Spheres& spheres);

  // Of the shortest collision at this closing speed [m/s] [s].
  double collision_time(double closing_speed) const;
  // In which the smallest sphere and what it meets come nearer by its radius [s].
  double crossing_time(double closing_speed) const;
  // Bound of the closing speed to expect: that of the spheres at the start, and of a fall through the domain
  // [m/s].
  double expected_speed(const Spheres& spheres, Vec3d gravity) const;

  // What a run has shown so far; save() and files keep it.
  struct Seen {
    double overlap = 0;        // largest, relative to the smaller radius [-]
    double speed = 0;          // largest of a sphere [m/s]
    double closing_speed = 0;  // bound of the largest [m/s]
    std::uint64_t windows = 0, beyond_overlap = 0, beyond_speed = 0, beyond_step = 0;
    double step = 0;  // shortest that was asked for, by a collision or to pass nothing by [s]; 0: none

    bool is_possible() const;
  };

  // Adds a window that ended at `time` [s]. Returns what to warn of, if anything is new.
  std::vector<std::string> observe(const WindowOutcome& outcome, const WindowPlan& plan, double time,
                                   Seen& seen);
  // The whole run, for the summary.
  std::vector<std::string> warnings(const Seen& seen) const;

 private:
  struct Smallest {
    MaterialId material;
    double radius = 0;  // [m]
  };
  double smallest_radius() const;  // [m]

  scene::Dem dem_;
  bool told_overlap_ = false, told_speed_ = false, told_step_ = false, told_travel_ = false;
  std::vector<Smallest> smallest_;  // sphere of each material that has any
};

}  // namespace tandem::dem
