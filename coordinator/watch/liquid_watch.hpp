// Checks whether the window suits the bodies in a liquid: warns once per body, before a run diverges, where
// the scheme multiplies an error of the velocity in each window (liquid_map.hpp, docs/coupling.md).
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/scene/model.hpp"
#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/liquid_modes.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// The direction of a body in which the scheme makes the most of a change of velocity.
struct LiquidFigures {
  double added = 0;   // added mass, as far as it was measured, over the mass of the body [-]
  double passed = 0;  // share of a change of velocity that the liquid gives back in the window [-]
  double growth = 1;  // per window, of the worst window [-]
  std::uint64_t windows_beyond = 0;
};

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
