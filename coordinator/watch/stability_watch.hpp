// Checks whether the window suits the contacts: estimates omega H and zeta of each boundary body from the
// stiffness and damping that the particle side reports, and warns once per body, before a run diverges.
//
// Contacts of the body with other bodies and the ground, where the multibody side reports them, hold the body
// as a support does (window_map.hpp), as if these bodies were at rest.
//
// The estimate uses the body's own mass and inertia. A body connected with the ground by one revolute or
// prismatic joint moves in that coordinate only. For any other body all motions are considered, without the
// inertia that its joints and neighbours add: its omega is then an upper bound. A body with prescribed motion
// cannot become unstable.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/freedoms.hpp"
#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/window_map.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// Vibration of a body on its contacts: the motion with the largest growth in a window.
struct Vibration {
  double omega_H = 0, zeta = 0;  // [-]
  double growth = 0;             // per window [-]
  Support support = {};
};
struct StabilityFigures {
  Vibration now, worst;  // at the end of the last window, and of the worst one
  double limit = 0;      // critical omega H at the first window beyond it [-]
  std::uint64_t windows_beyond = 0;
};

// Stable alternatives: omega H up to this value, for its damping; a window [s] of the scheme, 0: none; a
// scheme with this window, empty: none.
struct StabilityRemedy {
  double omega_H = 0;  // [-] at least 0.01, infinite: any
  double window = 0;
  std::string scheme;
};

class StabilityWatch {
 public:
  explicit StabilityWatch(const scene::Scene& scene);

  // Checks the contacts at the end of a window in which the bodies moved by `motion`: `tangents` of those
  // with particles, `supports` of those with other bodies. Returns a warning if there is a new one.
  std::optional<std::string> observe(const protocol::TangentSet& tangents,
                                     const protocol::TangentSet& supports, const protocol::MotionSet& motion);
  StabilityRemedy remedy(const Vibration& of_window) const;
  // `calls`: number of calls of observe().
  void save_or_restore(Archive& archive, std::uint64_t calls);
  // The largest window that suits the last contacts [s]; infinite where every window does. For adaptive
  // windows only: the search takes as long as a hundred estimates.
  double stable_window() const { return stable_window_; }
  const std::map<std::uint32_t, StabilityFigures>& bodies() const { return figures_; }  // by body

 private:
  struct Mode {
    double omega = 0, zeta = 0;  // [rad/s] [-]
    Support support;
  };
  std::vector<scene::Freedom> freedoms_;  // (bodies)
  std::vector<Mode> modes(const protocol::BodyTangent& tangent, const protocol::BodyTangent* support,
                          const Pose& pose) const;
  StabilityRemedy remedy(const Vibration& vibration, double H) const;
  std::string warning(std::uint32_t body, const StabilityFigures& figures, double H) const;

  const scene::Scene& scene_;
  std::map<std::uint32_t, StabilityFigures> figures_;
  double stable_window_ = std::numeric_limits<double>::infinity();
};

}  // namespace tandem::launch
