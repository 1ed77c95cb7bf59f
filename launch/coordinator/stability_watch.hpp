// Watches whether the window suits the contacts: estimates omega H and zeta of each boundary body from the
// stiffness and damping that the particle side reports, and warns, once per body, before a run diverges.
//
// The estimate takes the body's own mass and inertia. A body that hangs on the ground by one revolute or
// prismatic joint moves in that coordinate only; of any other body every motion is looked at, and what its
// joints and neighbours add to its inertia is not: its omega is then an upper bound. A body whose motion is
// prescribed cannot become unstable.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "launch/coordinator/archive.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// How a body vibrates on its contacts: the motion that grows most in a window.
struct Vibration {
  double omega_H = 0, zeta = 0;  // [-]
  double growth = 0;             // per window [-]
};
struct StabilityFigures {
  Vibration now, worst;  // at the end of the last window, and of the worst one
  double limit = 0;      // critical omega H where the first window was beyond it [-]
  std::uint64_t windows_beyond = 0;
};

// What would be stable: omega H up to this, for its damping; a window [s] of the scheme, 0: none; a scheme
// with this window, empty: none.
struct StabilityRemedy {
  double omega_H = 0;  // [-] at least 0.01, infinite: any
  double window = 0;
  std::string scheme;
};

class StabilityWatch {
 public:
  explicit StabilityWatch(const scene::Scene& scene);

  // Looks at the contacts at the end of a window that the bodies ended as `motion` says. Returns what to warn
  // of, if anything is new.
  std::optional<std::string> observe(const protocol::TangentSet& tangents, const protocol::MotionSet& motion);
  StabilityRemedy remedy(const Vibration& of_window) const;
  void keep(Archive& archive);
  // The largest window that suits the contacts seen last [s]; infinite where any does. For adaptive windows
  // alone: to find it takes as long as a hundred estimates.
  double stable_window() const { return stable_window_; }
  const std::map<std::uint32_t, StabilityFigures>& bodies() const { return figures_; }  // by body

 private:
  struct Mode {
    double omega = 0, zeta = 0;  // [rad/s] [-]
  };
  // Motions that a body is free to make: velocity and angular velocity (6 x freedoms), none: cannot move.
  std::vector<std::vector<std::array<double, 6>>> freedoms_;  // (bodies); empty list: all six
  std::vector<bool> fixed_;                                   // (bodies)
  std::vector<Mode> modes(const protocol::BodyTangent& tangent, const Pose& pose) const;
  StabilityRemedy remedy(const Vibration& vibration, double H) const;
  std::string warning(std::uint32_t body, const StabilityFigures& figures, double H) const;

  const scene::Scene& scene_;
  std::map<std::uint32_t, StabilityFigures> figures_;
  double stable_window_ = std::numeric_limits<double>::infinity();
};

}  // namespace tandem::launch
