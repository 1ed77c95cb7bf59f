// Watches the windows of a run: whether the micro step is short enough for the collisions, and whether
// overlaps and speeds stay within the limits of the scene. It does not stop a run: it warns once of each
// limit, and counts the windows beyond it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

class LimitWatch {
 public:
  LimitWatch() = default;
  LimitWatch(const scene::Dem& dem, const Spheres& spheres);

  // Duration of the shortest collision at this closing speed [m/s] [s].
  double collision_time(double closing_speed) const;
  // Time in which the smallest sphere and another surface approach each other by its radius [s].
  double crossing_time(double closing_speed) const;
  // The speed to expect, from the speeds at the start and a fall through the domain [m/s].
  double expected_speed(const Spheres& spheres, Vec3d gravity) const;

  // Extreme values and counts of a run so far. They are part of the state that save() and restart files keep.
  struct Record {
    double overlap = 0;        // largest, relative to the smaller radius [-]
    double speed = 0;          // largest speed of a sphere [m/s]
    double closing_speed = 0;  // bound of the largest closing speed [m/s]
    std::uint64_t windows = 0, beyond_overlap = 0, beyond_speed = 0, beyond_step = 0;
    double step = 0;  // shortest micro step that a window would have needed [s]; 0: none was too long

    bool is_possible() const;
  };

  // Adds a window that ended at `time` [s]. Returns new warnings.
  std::vector<std::string> observe(const WindowOutcome& outcome, const WindowPlan& plan, double time,
                                   Record& record);
  // Warnings about the whole run, for the summary.
  std::vector<std::string> warnings(const Record& record) const;

 private:
  struct Smallest {
    MaterialId material;
    double radius = 0;  // [m]
  };
  double smallest_radius() const;  // [m]

  scene::Dem dem_;
  bool warned_overlap_ = false, warned_speed_ = false, warned_step_ = false, warned_travel_ = false;
  std::vector<Smallest> smallest_;  // smallest sphere of each material that has spheres
};

}  // namespace tandem::dem
