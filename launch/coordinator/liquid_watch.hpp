// Checks whether the window suits the bodies in a liquid: warns once per body, before a run diverges, where
// the scheme multiplies an error of the velocity in each window (liquid_map.hpp, docs/coupling.md).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/scene/model.hpp"
#include "launch/coordinator/archive.hpp"
#include "launch/coordinator/body_modes.hpp"
#include "launch/coordinator/liquid_map.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// The direction of a body in which the liquid makes the most of a change of velocity.
struct LiquidFigures {
  double ratio = 0;        // added mass over the mass of the body, in that direction [-]
  double radiation_H = 0;  // radiation damping times the window over the mass [-]
  double growth = 1;       // per window, of the worst window [-]
  std::uint64_t windows_beyond = 0;
};

// The modes of a body with the radiation damping, and the added mass along each.
std::vector<std::pair<LiquidMode, Vector6>> liquid_modes(const protocol::BodyResponse& response,
                                                         const scene::Body& body,
                                                         const scene::Freedom& freedom, const Pose& pose,
                                                         double micro_step);
// Impulse that the body passes to the liquid in a window over the change of its velocity at the begin (6 x 6)
// [kg] [kg m] [kg m2].
Matrix6 passed_in(const protocol::BodyResponse& response, const scene::Body& body,
                  const scene::Freedom& freedom, const Pose& pose, double window);

class LiquidWatch {
 public:
  explicit LiquidWatch(const scene::Scene& scene);

  // Checks the bodies at the end of a window along `motion`, which had steps of `micro_step`. Returns a
  // warning if there is a new one.
  std::optional<std::string> observe(const std::vector<protocol::BodyResponse>& responses,
                                     const protocol::MotionSet& motion, double micro_step);
  // For adaptive windows: the longest one that suits all bodies [s]; infinite where every window does.
  double stable_window() const { return stable_window_; }
  const std::map<std::uint32_t, LiquidFigures>& bodies() const { return figures_; }  // by body
  void save_or_restore(Archive& archive);

 private:
  std::string warning(std::uint32_t body, const LiquidFigures& now, const LiquidMode& mode,
                      const Window& window) const;

  const scene::Scene& scene_;
  std::vector<scene::Freedom> freedoms_;
  std::map<std::uint32_t, LiquidFigures> figures_;
  double stable_window_ = std::numeric_limits<double>::infinity();
};

}  // namespace tandem::launch
