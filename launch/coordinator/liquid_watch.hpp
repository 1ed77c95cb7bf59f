// Checks whether the window suits the bodies in a liquid: warns once per body, before a run diverges, where
// the scheme multiplies an error of the velocity in each window (liquid_map.hpp, docs/coupling.md).
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/scene/model.hpp"
#include "launch/coordinator/archive.hpp"
#include "launch/coordinator/body_modes.hpp"
#include "launch/coordinator/liquid_map.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// The direction of a body in which the scheme makes the most of a change of velocity.
struct LiquidFigures {
  double added = 0;   // added mass, as far as it was measured, over the mass of the body [-]
  double passed = 0;  // share of a change of velocity that the liquid gives back in the window [-]
  double growth = 1;  // per window, of the worst window [-]
  std::uint64_t windows_beyond = 0;
};

// All points of the response of one body.
using Response = std::span<const protocol::BodyResponse>;
// Of each body that responds.
std::vector<Response> by_body(const std::vector<protocol::BodyResponse>& responses);

// The responses of a body along the directions in which its impulse over a window acts apart from each other,
// and these directions, of unit modal mass.
std::vector<std::pair<LiquidMode, Vector6>> liquid_modes(Response response, const scene::Body& body,
                                                         const scene::Freedom& freedom, const Pose& pose,
                                                         double window);
// Impulse that the body passes to the liquid in a window over the change of its velocity at the begin (6 x 6)
// [kg] [kg m] [kg m2].
Matrix6 passed_in(Response response, const scene::Body& body, const scene::Freedom& freedom, const Pose& pose,
                  double window);

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
  struct Judged {
    double window = 0, size = 0;  // of which window and response [s]
    LiquidFigures now = {};
    std::optional<LiquidMode> worst = {};
    double stable_window = std::numeric_limits<double>::infinity();
  };
  const Judged& judge(Response response, const Pose& pose, double H);
  std::string warning(std::uint32_t body, const LiquidFigures& now, const LiquidMode& mode,
                      const Window& window, double micro_step) const;

  const scene::Scene& scene_;
  std::vector<scene::Freedom> freedoms_;
  std::map<std::uint32_t, LiquidFigures> figures_;
  std::map<std::uint32_t, Judged> judged_;  // by body
  double stable_window_ = std::numeric_limits<double>::infinity();
};

}  // namespace tandem::launch
