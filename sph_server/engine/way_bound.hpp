// A bound on the way of particles since their lists were built, from the largest speed and acceleration.
#pragma once

#include <cmath>
#include <limits>

#include "common/math/vec3.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/engine/totals.hpp"
#include "sph_server/step/advance.hpp"

namespace tandem::sph {

// Ways and speeds are relative to the vessel.
class WayBound {
 public:
  // The lists are built.
  void begin() {
    farthest_ = 0;
    drift_ = {};
  }
  // Nothing is known: lists and state come from elsewhere.
  void forget() { farthest_ = acceleration_before_ = std::numeric_limits<double>::infinity(); }
  void measured(const Farthest& f) { farthest_ = std::sqrt(f.squared); }
  void without_step_before(const StepFigures& now) { acceleration_before_ = now.largest_acceleration; }

  // now: of the begin of the step, with speeds relative to `frame` [m/s]. drift: of the vessel at the end of
  // the step, since the lists were built [m].
  template <class Real>
  void add_step(const Advance<Real>& step, const StepFigures& now, Vec3d frame, Vec3d drift) {
    constexpr double rounding = 1 + 1e-6;
    const double acceleration =
        (1 + step.weight) * now.largest_acceleration + step.weight * acceleration_before_;
    const double way = step.dt * (now.largest_speed + 0.5 * step.dt * acceleration) +
                       0.5 * step.dt * (1 - step.damping) * (now.largest_speed + norm(frame)) +
                       norm(step.dt * frame - (drift - drift_));
    // Shifts have no bound that is known here.
    farthest_ = step.liquid.shift ? std::numeric_limits<double>::infinity()
                                  : farthest_ + rounding * way + 1e-9 * step.properties.spacing;
    drift_ = drift;
    acceleration_before_ = now.largest_acceleration;
  }
  double farthest() const { return farthest_; }  // [m]; not a number where a particle's motion is none

 private:
  double farthest_ = std::numeric_limits<double>::infinity();
  double acceleration_before_ =
      std::numeric_limits<double>::infinity();  // largest, of the step before [m/s2]
  Vec3d drift_;                                 // of the vessel at the end of the last step [m]
};

}  // namespace tandem::sph
